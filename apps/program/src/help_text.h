// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace headway::program {

/// One option or argument as --help shows it.
struct OptionText {
  char short_name = 0;  ///< 0: only the long name
  std::string long_name;
  std::string type;  ///< name of the value; empty: a flag
  std::string meaning;
  bool required = false;
};

/// What --help shows of a program, in the layout of GNU's programs, which help2man and shells read.
struct HelpText {
  std::string program;  ///< with its sub-command
  std::string summary;
  std::vector<std::pair<std::string, std::string>> arguments;  ///< name, meaning
  std::vector<OptionText> options;                             ///< in the order of declaration
  std::vector<OptionText> common_options;                      ///< after the others
};

std::ostream& operator<<(std::ostream& out, const HelpText& help);

/// One row of a list: the name in the left column, its meaning in the right one, in lines of at
/// most 79 characters.
void printRow(std::ostream& out, const std::string& name, const std::string& meaning);

}  // namespace headway::program
