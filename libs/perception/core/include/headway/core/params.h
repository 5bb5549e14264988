// SPDX-License-Identifier: BSD-3-Clause
// Parameters with names, units and ranges, bound to the fields of structs.
#pragma once

#include <functional>
#include <iosfwd>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace headway {

/// Registry of a program's parameters: name, unit, range and meaning; loaded from .ini files.
///
/// A parameter struct binds its fields once, in describe(); loading, validating and printing all
/// follow from that declaration. The bound fields must outlive the registry. Laws: loadFile() of
/// the output of print() changes no value; an unknown section or key, or a value that does not
/// parse or is out of range, changes nothing and throws.
///
///     struct MatchParams {
///       int max_disparity_px = 200;
///       void describe(Params::Section section) {
///         section.add("max_disparity_px", max_disparity_px, 16, 512, "px", "Maximum disparity");
///       }
///       void validate() const { validateRanges(*this, "slam"); }
///     };
///     Params params;
///     match_params.describe(params.section("slam"));
///     params.loadFile("headway.ini");
class Params {
 public:
  /// Which parameters to print.
  enum class Keys {
    kUser,    ///< those that a user is likely to change
    kExpert,  ///< the others
    kAll,     ///< the user keys of all sections, then the expert keys
  };

  /// Binds the fields of one struct. Several structs may use the same section.
  class Section {
   public:
    /// The same section; keys added through the result are user keys, the others expert keys.
    [[nodiscard]] Section user() const;

    void add(const std::string& key, double& field, double min, double max, const std::string& unit,
             const std::string& meaning);
    void add(const std::string& key, int& field, int min, int max, const std::string& unit,
             const std::string& meaning);
    void add(const std::string& key, bool& field, const std::string& meaning);
    void add(const std::string& key, std::string& field, const std::string& meaning);

    /// A field whose values have names, such as an enumeration.
    template <typename Enum>
    void add(const std::string& key, Enum& field,
             const std::vector<std::pair<std::string, Enum>>& choices, const std::string& meaning);

    /// A key of 0.3 that has another name since 0.4. Until 0.5 the former one sets the value, too,
    /// with one of warnings().
    ///
    /// @param convert  a value of the former key to one of the present key; empty: the same
    void renamed(const std::string& former, const std::string& present,
                 std::function<double(double)> convert = {});

   private:
    friend class Params;
    Section(Params& owner, std::string name) : owner_(owner), name_(std::move(name)) {}
    template <typename Number>
    void addNumber(const std::string& key, Number& field, Number min, Number max,
                   const std::string& unit, const std::string& meaning);
    void addChoice(const std::string& key, const std::vector<std::string>& names,
                   std::function<void(std::size_t)> set, std::function<std::size_t()> get,
                   const std::string& meaning);
    Params& owner_;
    std::string name_;
    bool is_user_ = false;
  };

  [[nodiscard]] Section section(const std::string& name) { return Section(*this, name); }

  /// Loads an .ini file (MRPT syntax: comments //, # and ;, \@define, ${variables}, $eval{}).
  ///
  /// @throws InputError naming file, section and key for what is unknown or out of range
  void loadFile(const std::string& path);

  /// Sets one parameter from "section.key=value".
  ///
  /// @throws InputError naming section and key for what is unknown or out of range
  void set(const std::string& assignment);

  /// A text for each former key that was used, which names it and the present one.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

  /// Checks the current values of the bound fields.
  ///
  /// @throws InputError naming section, key, value and range of the first that is out of range
  void validate() const;

  /// Value of one parameter as text, as print() would write it.
  ///
  /// @throws InputError if there is no such parameter
  [[nodiscard]] std::string get(const std::string& section, const std::string& key) const;

  /// Every value as text: section -> key -> value.
  [[nodiscard]] std::map<std::string, std::map<std::string, std::string>> values() const;

  /// Writes parameters with their current value, unit, range and meaning, as an .ini file.
  void print(std::ostream& out, Keys keys = Keys::kAll) const;

 private:
  struct Entry {
    std::string key;
    std::string meaning;                          ///< with unit and range
    std::function<void(const std::string&)> set;  ///< throws InputError("reason")
    std::function<std::string()> get;
    std::function<void()> check;  ///< throws InputError("reason"); empty: any value is valid
    bool is_user = false;
  };

  /// What became of a former key.
  struct Rename {
    std::string present;
    std::function<double(double)> convert;  ///< empty: the value is the same
  };

  void insert(const Section& section, Entry entry);
  void assign(const std::string& section, const std::string& key, const std::string& value);
  /// What became of a key of 0.3, which is noted for warnings(); null for another key.
  [[nodiscard]] const Rename* renameOf(const std::string& section, const std::string& key);
  void printKeys(std::ostream& out, bool user) const;
  [[nodiscard]] const Entry& find(const std::string& section, const std::string& key) const;

  std::vector<std::string> section_order_;
  std::map<std::string, std::vector<Entry>> entries_;
  std::map<std::string, std::map<std::string, Rename>> renamed_;  ///< by section and former key
  std::vector<std::string> warnings_;
};

/// Seconds of a number of frames at 10 Hz, the rate for which keys in frames had their defaults.
[[nodiscard]] inline double secondsOfFrames(double frames) { return frames / 10.0; }

/// Checks a struct that was filled in code against the ranges declared in its describe(). Called by
/// validate() of every XxxParams, and so by every constructor that takes such a struct.
///
/// @throws InputError naming section, key, value and range, as for a value from a file
template <typename Struct>
void validateRanges(Struct values, const std::string& section) {
  Params params;
  values.describe(params.section(section));
  params.validate();
}

/// The same for a struct whose describe() binds several sections.
template <typename Struct>
void validateRanges(Struct values) {
  Params params;
  values.describe(params);
  params.validate();
}

/// A struct after validate(), for initialiser lists: `params_(validated(params))`.
template <typename Struct>
[[nodiscard]] const Struct& validated(const Struct& values) {
  values.validate();
  return values;
}

template <typename Enum>
void Params::Section::add(const std::string& key, Enum& field,
                          const std::vector<std::pair<std::string, Enum>>& choices,
                          const std::string& meaning) {
  std::vector<std::string> names;
  std::vector<Enum> values;
  for (const auto& [name, value] : choices) {
    names.push_back(name);
    values.push_back(value);
  }
  addChoice(
      key, names, [&field, values](std::size_t i) { field = values.at(i); },
      [&field, values] {
        std::size_t i = 0;
        while (i < values.size() && values[i] != field) ++i;
        return i;
      },
      meaning);
}

}  // namespace headway
