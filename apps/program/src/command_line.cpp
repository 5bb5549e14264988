// SPDX-License-Identifier: BSD-3-Clause
// Command lines of the programs, their exit statuses and sub-commands.
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/core/version.h>
#include <headway/core/worker_thread.h>
#include <headway/program/command_line.h>
#include <headway/program/files.h>
#include <mrpt/3rdparty/tclap/CmdLine.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <ostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace headway::program {
namespace {

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

constexpr std::size_t kWidth = 79;
constexpr std::size_t kMeaningColumn = 29;

/// Prints words in lines of at most kWidth characters; the first one starts at `column`, the
/// others are indented.
void printWords(std::ostream& out, const std::string& text, std::size_t column,
                std::size_t indent) {
  std::istringstream words(text);
  bool first_of_line = true;
  for (std::string word; words >> word; first_of_line = false) {
    if (!first_of_line && column + 1 + word.size() > kWidth) {
      out << "\n" << std::string(indent, ' ');
      column = indent;
      first_of_line = true;
    }
    out << (first_of_line ? "" : " ") << word;
    column += word.size() + (first_of_line ? 0 : 1);
  }
  out << "\n";
}

std::string valueOf(const OptionText& option) {
  return option.type.empty() ? "" : " " + option.type;
}

std::string nameOf(const OptionText& option) {
  const std::string short_name =
      option.short_name == 0 ? "    " : std::string("-") + option.short_name + ", ";
  return short_name + "--" + option.long_name + valueOf(option);
}

std::string usageOf(const HelpText& help) {
  std::string usage = "Usage: " + help.program;
  for (const auto& [name, meaning] : help.arguments) usage += " " + name;
  for (const auto& option : help.options) {
    if (!option.required) continue;
    usage +=
        option.short_name == 0 ? " --" + option.long_name : std::string(" -") + option.short_name;
    usage += valueOf(option);
  }
  return usage + " [OPTION]...";
}

/// One row of a list: the name in the left column, its meaning in the right one, in lines of at
/// most 79 characters.
void printRow(std::ostream& out, const std::string& name, const std::string& meaning) {
  out << "  " << name;
  std::size_t column = name.size() + 2;
  if (column + 2 > kMeaningColumn) {
    out << "\n";
    column = 0;
  }
  out << std::string(kMeaningColumn - column, ' ');
  printWords(out, meaning, kMeaningColumn, kMeaningColumn);
}

std::ostream& operator<<(std::ostream& out, const HelpText& help) {
  const std::string usage = usageOf(help);
  printWords(out, usage, 0, 7);
  out << "\n";
  printWords(out, help.summary, 0, 0);
  if (!help.arguments.empty()) out << "\nArguments:\n";
  for (const auto& [name, meaning] : help.arguments) printRow(out, name, meaning);
  out << "\nOptions:\n";
  for (const auto* options : {&help.options, &help.common_options}) {
    for (const auto& option : *options) printRow(out, nameOf(option), option.meaning);
  }
  return out;
}

/// Until catchInterrupts(); files that are not complete have temporary names.
extern "C" void endAtOnce(int signal) { _exit(kSignalled + signal); }

/// A program's name without its sub-command.
std::string withoutSubcommand(const std::string& program) {
  return program.substr(0, program.find(' '));
}

void printVersion(const std::string& program) { std::cout << program << " " << kVersion << "\n"; }

void printSubcommands(const std::string& program, const std::string& summary,
                      const std::vector<Subcommand>& known) {
  std::cout << "Usage: " << program << " SUBCOMMAND [OPTION]...\n\n"
            << summary << "\n\nSub-commands:\n";
  for (const auto& known_one : known) printRow(std::cout, known_one.name, known_one.about);
  std::cout << "\n'" << program << " SUBCOMMAND --help' shows the options of one." << std::endl;
}

std::string shortFlag(char name) { return name == 0 ? "" : std::string(1, name); }

mrpt::system::VerbosityLevel verbosityFrom(const std::string& name) {
  static const std::map<std::string, mrpt::system::VerbosityLevel> levels = {
      {"DEBUG", mrpt::system::LVL_DEBUG},
      {"INFO", mrpt::system::LVL_INFO},
      {"WARN", mrpt::system::LVL_WARN},
      {"ERROR", mrpt::system::LVL_ERROR}};
  const auto level = levels.find(name);
  if (level != levels.end()) return level->second;
  throw UsageError("--verbosity: '" + name + "' is none of DEBUG, INFO, WARN, ERROR");
}

/// Prints help and version in the layout of GNU's programs, and stores a parse error for the
/// caller; TCLAP's own output would print a page and continue.
class Output : public TCLAP::StdOutput {
 public:
  void usage(TCLAP::CmdLineInterface& /*line*/) override { std::cout << help << std::flush; }
  void version(TCLAP::CmdLineInterface& /*line*/) override {
    printVersion(withoutSubcommand(help.program));
  }
  void failure(TCLAP::CmdLineInterface& /*line*/, TCLAP::ArgException& error) override {
    const std::string id = error.argId();
    const bool names_argument =
        id.find_first_not_of(' ') != std::string::npos && id.find("undefined") == std::string::npos;
    failure_text = (names_argument ? id + ": " : "") + error.error();
  }
  std::optional<std::string> failure_text;
  HelpText help;
};

}  // namespace

struct CommandLine::Arguments {
  Arguments(const std::string& name, const std::string& summary) : line(summary, ' ', kVersion) {
    output.help.program = name;
    output.help.summary = summary;
    delete line.getOutput();  // TCLAP does not free the output that it replaces
    line.setOutput(&output);
  }

  template <typename T>
  void value(T& target, char short_name, const std::string& name, const std::string& type,
             const std::string& meaning, bool required) {
    auto arg = std::make_shared<TCLAP::ValueArg<T>>(shortFlag(short_name), name, meaning, required,
                                                    target, type, line);
    declare(arg, {short_name, name, type, meaning, required},
            [arg, &target] { target = arg->getValue(); });
  }

  void repeatable(std::vector<std::string>& target, char short_name, const std::string& name,
                  const std::string& type, const std::string& meaning) {
    auto arg = std::make_shared<TCLAP::MultiArg<std::string>>(shortFlag(short_name), name, meaning,
                                                              false, type, line);
    declare(arg, {short_name, name, type, meaning, false},
            [arg, &target] { target = arg->getValue(); });
  }

  std::shared_ptr<TCLAP::SwitchArg> flag(bool& target, char short_name, const std::string& name,
                                         const std::string& meaning) {
    auto arg =
        std::make_shared<TCLAP::SwitchArg>(shortFlag(short_name), name, meaning, line, false);
    declare(arg, {short_name, name, "", meaning, false}, [&target] { target = true; });
    return arg;
  }

  /// Keeps an option and lists it in --help.
  template <typename Arg>
  void declare(std::shared_ptr<Arg> arg, OptionText text, std::function<void()> apply) {
    keep(std::move(arg), std::move(apply));
    output.help.options.push_back(std::move(text));
  }

  template <typename Arg>
  void keep(std::shared_ptr<Arg> arg, std::function<void()> apply) {
    owned.push_back(arg);
    applied.push_back([arg, apply = std::move(apply)] {
      if (arg->isSet()) apply();
    });
  }

  [[nodiscard]] bool askedForConfig() const {
    return dump_config_switch != nullptr && dump_config_switch->isSet();
  }

  std::vector<std::shared_ptr<TCLAP::Arg>> owned;  // outlives `line`, which refers to them
  std::vector<std::function<void()>> applied;
  Output output;
  TCLAP::CmdLine line;
  std::vector<std::string> configs;
  std::vector<std::string> assignments;
  std::shared_ptr<TCLAP::SwitchArg> dump_config_switch;
  bool dump_config = false;
  bool expert = false;
  std::string verbosity = "INFO";
};

CommandLine::CommandLine(const std::string& program, const std::string& summary)
    : arguments_(std::make_unique<Arguments>(program, summary)) {
  flag(quiet_, 'q', "quiet", "Print errors only");
  option(arguments_->verbosity, 'v', "verbosity", "LEVEL",
         "Least important messages to print: DEBUG, INFO, WARN or ERROR");
  auto& help = arguments_->output.help;
  help.common_options.swap(help.options);
  help.common_options.push_back({'h', "help", "", "Print this help and end", false});
  help.common_options.push_back({0, "version", "", "Print the version and end", false});
}

CommandLine::~CommandLine() = default;

void CommandLine::positional(std::string& target, const std::string& name,
                             const std::string& meaning) {
  auto arg = std::make_shared<TCLAP::UnlabeledValueArg<std::string>>(name, meaning, true, "", name,
                                                                     arguments_->line);
  arguments_->keep(arg, [arg, &target] { target = arg->getValue(); });
  arguments_->output.help.arguments.emplace_back(name, meaning);
}

void CommandLine::flag(bool& target, char short_name, const std::string& name,
                       const std::string& meaning) {
  arguments_->flag(target, short_name, name, meaning);
}

void CommandLine::option(std::string& target, char short_name, const std::string& name,
                         const std::string& type, const std::string& meaning, bool required) {
  arguments_->value(target, short_name, name, type, meaning, required);
}

void CommandLine::option(double& target, char short_name, const std::string& name,
                         const std::string& type, const std::string& meaning) {
  arguments_->value(target, short_name, name, type, meaning, false);
}

void CommandLine::option(int& target, char short_name, const std::string& name,
                         const std::string& type, const std::string& meaning) {
  arguments_->value(target, short_name, name, type, meaning, false);
}

void CommandLine::option(std::optional<std::size_t>& target, char short_name,
                         const std::string& name, const std::string& type,
                         const std::string& meaning) {
  auto arg = std::make_shared<TCLAP::ValueArg<long long>>(shortFlag(short_name), name, meaning,
                                                          false, 0, type, arguments_->line);
  arguments_->declare(arg, {short_name, name, type, meaning, false}, [arg, &target, name] {
    if (arg->getValue() < 0) throw UsageError("--" + name + " must not be negative");
    target = static_cast<std::size_t>(arg->getValue());
  });
}

void CommandLine::option(std::vector<std::string>& target, char short_name, const std::string& name,
                         const std::string& type, const std::string& meaning) {
  arguments_->repeatable(target, short_name, name, type, meaning);
}

void CommandLine::parameters(Params& params) {
  params_ = &params;
  arguments_->repeatable(arguments_->configs, 'c', "config", "FILE.ini",
                         "Configuration file; repeatable, later files win");
  arguments_->repeatable(arguments_->assignments, 0, "set", "section.key=value",
                         "One parameter; wins over the files; repeatable");
  arguments_->dump_config_switch =
      arguments_->flag(arguments_->dump_config, 0, "dump-config",
                       "Print the user parameters with value, unit and meaning, and end");
  flag(arguments_->expert, 0, "expert", "With --dump-config: print the expert parameters, too");
}

bool CommandLine::parse(int argc, const char* const* argv) {
  std::vector<const char*> words(argv, argv + argc);
  if (!arguments_->line.parse(argc, words.data())) {
    const auto& failure = arguments_->output.failure_text;
    if (!failure) return false;
    // --dump-config works without the required options.
    const bool is_missing = failure->find("required arguments missing") != std::string::npos;
    if (!(is_missing && arguments_->askedForConfig())) {
      throw UsageError(*failure + " (--help shows the options)");
    }
  }
  for (const auto& apply : arguments_->applied) apply();
  const auto level = verbosityFrom(arguments_->verbosity);
  verbosity_ = quiet_ ? mrpt::system::LVL_ERROR : level;
  if (params_ != nullptr) {
    for (const auto& path : arguments_->configs) params_->loadFile(findDataFile(path));
    if (after_files_) after_files_();
    for (const auto& assignment : arguments_->assignments) params_->set(assignment);
    for (const auto& text : params_->warnings()) {
      std::cerr << withoutSubcommand(arguments_->output.help.program) << ": " << printable(text)
                << std::endl;
    }
  }
  if (arguments_->dump_config) {
    params_->print(std::cout, arguments_->expert ? Params::Keys::kAll : Params::Keys::kUser);
    return false;
  }
  if (arguments_->expert) throw UsageError("--expert: only together with --dump-config");
  return true;
}

int run(const std::string& program, const std::function<int()>& body) {
  std::signal(SIGXFSZ, SIG_IGN);
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, endAtOnce);
  if (std::signal(SIGHUP, endAtOnce) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  const auto status = [](int otherwise) {
    return stopRequested() ? kSignalled + stopRequest() : otherwise;
  };
  try {
    return status(body());
  } catch (const UsageError& error) {
    std::cerr << program << ": " << printable(error.what()) << std::endl;
    return kUsage;
  } catch (const std::exception& error) {
    std::cerr << program << ": " << printable(error.what()) << std::endl;
    return status(kInputFault);
  }
}

int runSubcommand(int argc, const char** argv, const std::string& summary,
                  const std::vector<Subcommand>& known) {
  const std::string program = std::filesystem::path(argv[0]).filename().string();
  const std::string given = argc > 1 ? argv[1] : "";
  if (given == "--version") {
    printVersion(program);
    return kDone;
  }
  if (given == "--help" || given == "-h") {
    printSubcommands(program, summary, known);
    return kDone;
  }
  std::string list;
  for (const auto& subcommand : known) {
    if (subcommand.name == given) {
      argv[1] = argv[0];
      return subcommand.run(argc - 1, argv + 1);
    }
    list += (list.empty() ? "" : ", ") + subcommand.name;
  }
  throw UsageError((given.empty() ? "a sub-command is missing" : "'" + given + "' is unknown") +
                   "; sub-commands are " + list);
}

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> parts;
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, ',');) parts.push_back(word);
  return parts;
}

std::string textOf(const Params& params) {
  std::ostringstream text;
  params.print(text);
  return text.str();
}

}  // namespace headway::program
