// SPDX-License-Identifier: BSD-3-Clause
// Command lines of the programs, their exit statuses and sub-commands.
#pragma once

#include <headway/core/params.h>
#include <mrpt/system/COutputLogger.h>

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace headway::program {

/// Error in the command line: exit status 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Command line with the options common to all programs and those of one program.
///
/// Every program has --help, --version, -v/--verbosity and -q/--quiet; with parameters() also
/// -c/--config, --set, --dump-config and --expert. Targets keep their value if the option is not
/// given.
///
///     std::string input;
///     CommandLine line("headway-export", "Writes a rawlog as a KITTI odometry folder.");
///     line.positional(input, "IN.rawlog", "rawlog to read");
///     if (!line.parse(argc, argv)) return kDone;  // --help, --version or --dump-config
class CommandLine {
 public:
  CommandLine(const std::string& program, const std::string& summary);
  ~CommandLine();

  /// Next argument without a dash; must be given.
  void positional(std::string& target, const std::string& name, const std::string& meaning);
  /// @param short_name  0: only the long name
  void flag(bool& target, char short_name, const std::string& name, const std::string& meaning);
  void option(std::string& target, char short_name, const std::string& name,
              const std::string& type, const std::string& meaning, bool required = false);
  void option(double& target, char short_name, const std::string& name, const std::string& type,
              const std::string& meaning);
  void option(int& target, char short_name, const std::string& name, const std::string& type,
              const std::string& meaning);
  void option(std::optional<std::size_t>& target, char short_name, const std::string& name,
              const std::string& type, const std::string& meaning);
  /// An option whose value may be left out: it is empty then.
  void option(std::optional<std::string>& target, char short_name, const std::string& name,
              const std::string& type, const std::string& meaning);
  /// May be given several times.
  void option(std::vector<std::string>& target, char short_name, const std::string& name,
              const std::string& type, const std::string& meaning);
  /// Adds -c, --set, --dump-config and --expert; `params` must outlive parse().
  void parameters(Params& params);
  /// Calls back when the configuration files are loaded, before --set is applied.
  void afterFiles(std::function<void()> apply) { after_files_ = std::move(apply); }

  /// Reads the arguments into the targets, then the configuration into the parameters.
  ///
  /// @return false if the program has nothing more to do (--help, --version, --dump-config)
  /// @throws UsageError, InputError
  [[nodiscard]] bool parse(int argc, const char* const* argv);

  [[nodiscard]] bool quiet() const { return quiet_; }
  [[nodiscard]] mrpt::system::VerbosityLevel verbosity() const { return verbosity_; }

 private:
  bool readWords(int argc, const char* const* argv);

  struct Arguments;
  std::unique_ptr<Arguments> arguments_;
  Params* params_ = nullptr;
  std::function<void()> after_files_;
  bool quiet_ = false;
  mrpt::system::VerbosityLevel verbosity_ = mrpt::system::LVL_INFO;
};

inline constexpr int kDone = 0;
inline constexpr int kInputFault = 1;
inline constexpr int kUsage = 2;
inline constexpr int kSignalled = 128;  ///< plus the number of the signal, as shells report it

/// Runs the main function of a program and reports exceptions as one line on standard error and as
/// exit status: UsageError 2, other exceptions 1. SIGINT, SIGTERM and SIGHUP end the program with
/// kSignalled + signal: at once, or cleanly after catchInterrupts(). Writing beyond a limit of file
/// size is an exception, as on a full disk.
int run(const std::string& program, const std::function<int()>& body);

/// One of a program's sub-commands.
struct Subcommand {
  std::string name;
  std::string about;                          ///< what it does, in one sentence, for --help
  std::function<int(int, const char**)> run;  ///< with its own arguments; returns the exit status
};

/// Runs the sub-command that the first argument names; --help and --version are of the program.
///
/// @param summary  what the program does, for --help
/// @return the exit status
/// @throws UsageError listing the sub-commands if it is unknown
int runSubcommand(int argc, const char** argv, const std::string& summary,
                  const std::vector<Subcommand>& known);

/// The parts of a list such as "1,2,3"; none of an empty one.
[[nodiscard]] std::vector<std::string> split(const std::string& list);

/// All parameters as the text of an .ini file.
[[nodiscard]] std::string textOf(const Params& params);

}  // namespace headway::program
