// SPDX-License-Identifier: BSD-3-Clause
// Command lines of the programs, their exit statuses and sub-commands.
#include <headway/core/error.h>
#include <headway/core/input_files.h>
#include <headway/core/text.h>
#include <headway/core/version.h>
#include <headway/core/worker_thread.h>
#include <headway/program/command_line.h>
#include <headway/program/files.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>
#include <sstream>

namespace headway::program {
namespace {

/// Until catchInterrupts(); files that are not complete have temporary names.
extern "C" void endAtOnce(int signal) { _exit(kSignalled + signal); }

// The layout of --help, which is that of GNU's programs: help2man and shells read it.
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

/// One row of a list: the name in the left column, its meaning in the right one.
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

/// "-o" and "--output"; empty if the option has none.
std::string shortNameOf(const CLI::Option& option) {
  return option.get_snames().empty() ? "" : "-" + option.get_snames().front();
}
std::string longNameOf(const CLI::Option& option) { return "--" + option.get_lnames().front(); }

/// The value's type after a name.
std::string withType(const std::string& name, const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return name + (type.empty() ? "" : " " + type);
}

void printHelp(std::ostream& out, const CLI::App& app) {
  std::string usage = "Usage: " + app.get_name();
  const auto arguments = app.get_options([](const CLI::Option* o) { return o->get_positional(); });
  const auto options = app.get_options([](const CLI::Option* o) { return !o->get_positional(); });
  for (const auto* argument : arguments) usage += " " + argument->get_type_name();
  for (const auto* option : options) {
    if (!option->get_required()) continue;
    const std::string short_name = shortNameOf(*option);
    usage += " " + withType(short_name.empty() ? longNameOf(*option) : short_name, *option);
  }
  printWords(out, usage + " [OPTION]...", 0, 7);
  out << "\n";
  printWords(out, app.get_description(), 0, 0);
  if (!arguments.empty()) out << "\nArguments:\n";
  for (const auto* argument : arguments) {
    printRow(out, argument->get_type_name(), argument->get_description());
  }
  out << "\nOptions:\n";
  for (const auto* option : options) {
    const std::string short_name = shortNameOf(*option);
    printRow(
        out,
        (short_name.empty() ? "    " : short_name + ", ") + withType(longNameOf(*option), *option),
        option->get_description());
  }
  out << std::flush;
}

void printSubcommands(const std::string& program, const std::string& summary,
                      const std::vector<Subcommand>& known) {
  std::cout << "Usage: " << program << " SUBCOMMAND [OPTION]...\n\n"
            << summary << "\n\nSub-commands:\n";
  for (const auto& subcommand : known) printRow(std::cout, subcommand.name, subcommand.about);
  std::cout << "\n'" << program << " SUBCOMMAND --help' shows the options of one." << std::endl;
}

/// A program's name without its sub-command.
std::string withoutSubcommand(const std::string& program) {
  return program.substr(0, program.find(' '));
}

std::string versionOf(const std::string& program) { return program + " " + kVersion; }

UsageError usageError(const std::string& text) {
  return UsageError(text + " (--help shows the options)");
}

/// An error in one option: "Argument: -o (--output): text".
UsageError optionError(const CLI::Option& option, const std::string& text) {
  const std::string short_name = shortNameOf(option);
  return usageError("Argument: " + (short_name.empty() ? "" : short_name + " ") + "(" +
                    longNameOf(option) + "): " + text);
}

/// The required options and arguments that are not given, as an error names them.
UsageError missingError(const CLI::App& app) {
  std::string names;
  int count = 0;
  for (const auto* option : app.get_options()) {
    if (!option->get_required() || option->count() > 0) continue;
    const std::string short_name = option->get_positional() ? "" : shortNameOf(*option);
    names += (count++ == 0 ? "" : ", ") + (short_name.empty() ? "" : short_name + "/") +
             (option->get_positional() ? option->get_type_name() : longNameOf(*option));
  }
  return usageError(names + (count == 1 ? ": is required" : ": are required"));
}

template <typename T>
T numberOf(const CLI::Option& option, const std::string& text) {
  std::istringstream in(text);
  T value{};
  if (in >> value && in.peek() == std::istringstream::traits_type::eof()) return value;
  throw optionError(option, "Couldn't read argument value from string '" + text + "'");
}

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

/// Whether an option names what is written; every other file on the command line is read.
bool isOutput(const CLI::Option& option) {
  constexpr std::array kOutputs = {"output", "json", "plot", "record", "video", "worst"};
  const auto& names = option.get_lnames();
  return !names.empty() &&
         std::find(kOutputs.begin(), kOutputs.end(), names.front()) != kOutputs.end();
}

/// The words after the program's name, in the reverse order that CLI11 takes. "--name=" is split
/// from its empty value, because CLI11 would take the next word instead.
std::vector<std::string> reversedWords(int argc, const char* const* argv) {
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    std::string word = argv[i];
    const bool has_empty_value =
        word.size() > 3 && word.rfind("--", 0) == 0 && word.find('=') == word.size() - 1;
    if (has_empty_value) word.pop_back();
    words.push_back(word);
    if (has_empty_value) words.emplace_back();
  }
  std::reverse(words.begin(), words.end());
  return words;
}

}  // namespace

struct CommandLine::Arguments {
  Arguments(const std::string& name, const std::string& summary) : app(summary, name) {
    app.set_help_flag();  // parse() adds it after the program's options
    app.allow_extras();
  }

  using Read = std::function<void(const CLI::Option& option, const std::string& value)>;

  static std::string namesOf(char short_name, const std::string& name) {
    return (short_name == 0 ? "" : std::string("-") + short_name + ",") + "--" + name;
  }

  /// Declares an option with a value, or an argument; `read` is called with each value.
  CLI::Option& value(const std::string& names, const std::string& type, const std::string& meaning,
                     Read read) {
    const CLI::callback_t keep = [](const CLI::results_t&) { return true; };
    auto* option = app.add_option(names, keep, meaning)
                       ->type_name(type)
                       ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    readers.emplace_back(option, std::move(read));
    return *option;
  }

  template <typename T>
  void number(T& target, char short_name, const std::string& name, const std::string& type,
              const std::string& meaning) {
    value(namesOf(short_name, name), type, meaning,
          [&target](const CLI::Option& option, const std::string& text) {
            target = numberOf<T>(option, text);
          });
  }

  /// Stores the values in the targets. @throws UsageError
  void read() const {
    for (const auto& [option, read_value] : readers) {
      const bool is_repeatable = repeatable.count(option) > 0;
      if (!is_repeatable && option->count() > 1)
        throw optionError(*option, "Argument already set!");
      for (const auto& text : option->results()) read_value(*option, text);
    }
  }

  /// Registers the files that are read, and refuses to write them.
  ///
  /// @throws InputError
  void protectInputs() const {
    for (const auto& [option, read_value] : readers) {
      if (isOutput(*option)) continue;
      for (const auto& text : option->results()) {
        registerInput(text);
        registerInputsIn(text);
        std::istringstream parts(text);  // of a list, such as plug-ins
        for (std::string part; std::getline(parts, part, ',');) registerInput(part);
      }
    }
    for (const auto& path : configs) registerInput(findDataFile(path));
    for (const auto& [option, read_value] : readers) {
      if (!isOutput(*option)) continue;
      for (const auto& text : option->results()) requireNoInput(text);
    }
  }

  CLI::App app;
  std::vector<std::pair<CLI::Option*, Read>> readers;
  std::set<const CLI::Option*> repeatable;
  std::vector<std::string> configs;
  std::vector<std::string> assignments;
  bool dump_config = false;
  bool expert = false;
  std::string verbosity = "INFO";
};

CommandLine::CommandLine(const std::string& program, const std::string& summary)
    : arguments_(std::make_unique<Arguments>(program, summary)) {}

CommandLine::~CommandLine() = default;

void CommandLine::positional(std::string& target, const std::string& name,
                             const std::string& meaning) {
  arguments_
      ->value(name, name, meaning,
              [&target](const CLI::Option&, const std::string& text) { target = text; })
      .required();
}

void CommandLine::flag(bool& target, char short_name, const std::string& name,
                       const std::string& meaning) {
  auto* option = arguments_->app.add_flag(Arguments::namesOf(short_name, name), meaning);
  option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)->disable_flag_override();
  arguments_->readers.emplace_back(
      option, [&target](const CLI::Option&, const std::string&) { target = true; });
}

void CommandLine::option(std::string& target, char short_name, const std::string& name,
                         const std::string& type, const std::string& meaning, bool required) {
  arguments_
      ->value(Arguments::namesOf(short_name, name), type, meaning,
              [&target](const CLI::Option&, const std::string& text) { target = text; })
      .required(required);
}

void CommandLine::option(double& target, char short_name, const std::string& name,
                         const std::string& type, const std::string& meaning) {
  arguments_->number(target, short_name, name, type, meaning);
}

void CommandLine::option(int& target, char short_name, const std::string& name,
                         const std::string& type, const std::string& meaning) {
  arguments_->number(target, short_name, name, type, meaning);
}

void CommandLine::option(std::optional<std::size_t>& target, char short_name,
                         const std::string& name, const std::string& type,
                         const std::string& meaning) {
  arguments_->value(Arguments::namesOf(short_name, name), type, meaning,
                    [&target](const CLI::Option& option, const std::string& text) {
                      const auto number = numberOf<long long>(option, text);
                      if (number < 0)
                        throw UsageError(longNameOf(option) + " must not be negative");
                      target = static_cast<std::size_t>(number);
                    });
}

void CommandLine::option(std::optional<std::string>& target, char short_name,
                         const std::string& name, const std::string& type,
                         const std::string& meaning) {
  const std::string none = "true";  // what CLI11 gives instead of a value that is left out
  arguments_
      ->value(Arguments::namesOf(short_name, name), type, meaning,
              [&target, none](const CLI::Option&, const std::string& text) {
                target = text == none ? "" : text;
              })
      .expected(0, 1);
}

void CommandLine::option(std::vector<std::string>& target, char short_name, const std::string& name,
                         const std::string& type, const std::string& meaning) {
  arguments_->repeatable.insert(&arguments_->value(
      Arguments::namesOf(short_name, name), type, meaning,
      [&target](const CLI::Option&, const std::string& text) { target.push_back(text); }));
}

void CommandLine::parameters(Params& params) {
  params_ = &params;
  option(arguments_->configs, 'c', "config", "FILE.ini",
         "Configuration file; repeatable, later files win");
  option(arguments_->assignments, 0, "set", "section.key=value",
         "One parameter; wins over the files; repeatable");
  flag(arguments_->dump_config, 0, "dump-config",
       "Print the user parameters with value, unit and meaning, and end");
  flag(arguments_->expert, 0, "expert", "With --dump-config: print the expert parameters, too");
}

/// Reads the words into the targets; false after --help and --version.
bool CommandLine::readWords(int argc, const char* const* argv) {
  CLI::App& app = arguments_->app;
  bool is_complete = true;
  auto words = reversedWords(argc, argv);
  const std::string last_word = words.empty() ? "" : words.front();
  try {
    app.parse(words);
  } catch (const CLI::CallForHelp&) {
    printHelp(std::cout, app);
    return false;
  } catch (const CLI::CallForVersion& version) {
    std::cout << version.what() << std::endl;
    return false;
  } catch (const CLI::RequiredError&) {
    is_complete = false;
  } catch (const CLI::ArgumentMismatch& error) {
    // An option without its value is the last word; a flag with one may be anywhere.
    const auto* last = app.get_option_no_throw(last_word);
    if (last == nullptr || last->get_positional() || last->get_expected_min() == 0) {
      throw usageError(error.what());
    }
    throw optionError(*last, "Missing a value for this argument!");
  } catch (const CLI::ParseError& error) {
    throw usageError(error.what());
  }
  for (const auto& word : app.remaining()) {
    if (word == "--") continue;  // CLI11 keeps the mark after which no word is an option
    throw usageError("Argument: " + word + ": Couldn't find match for argument");
  }
  arguments_->read();
  if (!is_complete && !arguments_->dump_config) throw missingError(app);
  return true;
}

bool CommandLine::parse(int argc, const char* const* argv) {
  const std::string program = withoutSubcommand(arguments_->app.get_name());
  flag(quiet_, 'q', "quiet", "Print errors only");
  option(arguments_->verbosity, 'v', "verbosity", "LEVEL",
         "Least important messages to print: DEBUG, INFO, WARN or ERROR");
  arguments_->app.set_help_flag("-h,--help", "Print this help and end");
  arguments_->app.set_version_flag("--version", versionOf(program), "Print the version and end");
  if (!readWords(argc, argv)) return false;
  arguments_->protectInputs();
  const auto level = verbosityFrom(arguments_->verbosity);
  verbosity_ = quiet_ ? mrpt::system::LVL_ERROR : level;
  if (params_ != nullptr) {
    for (const auto& path : arguments_->configs) params_->loadFile(findDataFile(path));
    if (after_files_) after_files_();
    for (const auto& assignment : arguments_->assignments) params_->set(assignment);
    for (const auto& [section, values] : params_->values()) {
      for (const auto& [key, value] : values) registerInput(value);  // such as a network
    }
    for (const auto& text : params_->warnings()) {
      std::cerr << program << ": " << printable(text) << std::endl;
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
    const int result = body();
    std::cout.flush();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0 || !std::cout) {
      throw InputError("standard output: not written completely; check the disk space");
    }
    return status(result);
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
    std::cout << versionOf(program) << std::endl;
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
