// SPDX-License-Identifier: BSD-3-Clause
// Parameters with names, units and ranges, bound to the fields of structs.
#include <headway/core/error.h>
#include <headway/core/params.h>
#include <mrpt/config/CConfigFile.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <ostream>

namespace headway {
namespace {

template <typename Number>
std::string toText(Number value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end.ptr};
}

template <typename Number>
std::string rangeText(Number min, Number max, const std::string& unit) {
  return "[" + (unit.empty() ? "" : unit + ", ") + toText(min) + " .. " + toText(max) + "]";
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

template <typename Number>
void requireInRange(Number value, Number min, Number max, const std::string& unit,
                    const std::string& text) {
  if (!(value >= min && value <= max)) {
    throw InputError("'" + text + "' is out of range " + rangeText(min, max, unit));
  }
}

template <typename Number>
Number parseNumber(const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw InputError("'" + text + "' is not a number");
  }
  return value;
}

bool parseBool(const std::string& text) {
  if (text == "true" || text == "1" || text == "yes") return true;
  if (text == "false" || text == "0" || text == "no") return false;
  throw InputError("'" + text + "' is neither true nor false");
}

std::string joined(const std::vector<std::string>& names, const std::string& separator) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : separator) + name;
  return text;
}

}  // namespace

Params::Section Params::Section::user() const {
  Section section = *this;
  section.is_user_ = true;
  return section;
}

template <typename Number>
void Params::Section::addNumber(const std::string& key, Number& field, Number min, Number max,
                                const std::string& unit, const std::string& meaning) {
  const auto set = [&field, min, max, unit](const std::string& text) {
    const auto value = parseNumber<Number>(text);
    requireInRange(value, min, max, unit, text);
    field = value;
  };
  owner_.insert(
      *this,
      {key, meaning + " " + rangeText(min, max, unit), set, [&field] { return toText(field); },
       [&field, min, max, unit] { requireInRange(field, min, max, unit, toText(field)); }});
}

void Params::Section::add(const std::string& key, double& field, double min, double max,
                          const std::string& unit, const std::string& meaning) {
  addNumber(key, field, min, max, unit, meaning);
}

void Params::Section::add(const std::string& key, int& field, int min, int max,
                          const std::string& unit, const std::string& meaning) {
  addNumber(key, field, min, max, unit, meaning);
}

void Params::Section::add(const std::string& key, bool& field, const std::string& meaning) {
  owner_.insert(*this, {key,
                        meaning + " [true | false]",
                        [&field](const std::string& text) { field = parseBool(text); },
                        [&field] { return std::string(field ? "true" : "false"); },
                        {}});
}

void Params::Section::add(const std::string& key, std::string& field, const std::string& meaning) {
  owner_.insert(*this, {key,
                        meaning,
                        [&field](const std::string& text) { field = text; },
                        [&field] { return field; },
                        {}});
}

void Params::Section::addChoice(const std::string& key, const std::vector<std::string>& names,
                                std::function<void(std::size_t)> set,
                                std::function<std::size_t()> get, const std::string& meaning) {
  const auto setByName = [names, set = std::move(set)](const std::string& text) {
    const auto it = std::find(names.begin(), names.end(), text);
    if (it == names.end()) {
      throw InputError("'" + text + "' is none of " + joined(names, ", "));
    }
    set(static_cast<std::size_t>(it - names.begin()));
  };
  owner_.insert(*this, {key, meaning + " [" + joined(names, " | ") + "]", setByName,
                        [names, get] { return names.at(get()); },
                        [names, get] {
                          if (get() < names.size()) return;
                          throw InputError("the value is none of " + joined(names, ", "));
                        }});
}

void Params::Section::renamed(const std::string& former, const std::string& present,
                              std::function<double(double)> convert) {
  owner_.renamed_[name_][former] = {present, std::move(convert)};
}

void Params::insert(const Section& section, Entry entry) {
  if (entries_.count(section.name_) == 0) section_order_.push_back(section.name_);
  entry.is_user = section.is_user_;
  entries_[section.name_].push_back(std::move(entry));
}

const Params::Entry& Params::find(const std::string& section, const std::string& key) const {
  const auto entries = entries_.find(section);
  if (entries == entries_.end()) {
    throw InputError("[" + section + "] is not a known section; known are " +
                     joined(section_order_, ", "));
  }
  const auto entry = std::find_if(entries->second.begin(), entries->second.end(),
                                  [&](const Entry& e) { return e.key == key; });
  if (entry != entries->second.end()) return *entry;
  throw InputError("[" + section + "] has no key '" + key + "'; --dump-config --expert lists them");
}

const Params::Rename* Params::renameOf(const std::string& section, const std::string& key) {
  const auto table = renamed_.find(section);
  if (table == renamed_.end()) return nullptr;
  const auto rename = table->second.find(key);
  if (rename == table->second.end()) return nullptr;
  const std::string text = "[" + section + "] " + key + " is now " + rename->second.present +
                           (rename->second.convert ? ", in another unit" : "") +
                           "; the former name has an effect until version 0.5";
  if (std::find(warnings_.begin(), warnings_.end(), text) == warnings_.end()) {
    warnings_.push_back(text);
  }
  return &rename->second;
}

void Params::assign(const std::string& section, const std::string& key, const std::string& value) {
  const Rename* rename = renameOf(section, key);
  const Entry& entry = find(section, rename != nullptr ? rename->present : key);
  try {
    const bool converts = rename != nullptr && rename->convert;
    entry.set(converts ? toText(rename->convert(parseNumber<double>(trimmed(value))))
                       : trimmed(value));
  } catch (const InputError& error) {
    throw InputError("[" + section + "] " + key + ": " + error.what());
  }
}

void Params::loadFile(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) {
    throw InputError(path + ": no such configuration file");
  }
  try {
    const mrpt::config::CConfigFile file(path);
    std::vector<std::string> sections;
    file.getAllSections(sections);
    for (const auto& section : sections) {
      std::vector<std::string> keys;
      file.getAllKeys(section, keys);
      for (const auto& key : keys) assign(section, key, file.read_string(section, key, "", true));
    }
  } catch (const std::exception& error) {
    throw InputError(path + ": " + error.what());
  }
}

void Params::set(const std::string& assignment) {
  const auto equals = assignment.find('=');
  const auto dot = assignment.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot > equals) {
    throw InputError("'" + assignment + "' is not of the form section.key=value");
  }
  assign(trimmed(assignment.substr(0, dot)), trimmed(assignment.substr(dot + 1, equals - dot - 1)),
         assignment.substr(equals + 1));
}

void Params::validate() const {
  for (const auto& section : section_order_) {
    for (const auto& entry : entries_.at(section)) {
      if (!entry.check) continue;
      try {
        entry.check();
      } catch (const InputError& error) {
        throw InputError("[" + section + "] " + entry.key + ": " + error.what());
      }
    }
  }
}

std::string Params::get(const std::string& section, const std::string& key) const {
  return find(section, key).get();
}

std::map<std::string, std::map<std::string, std::string>> Params::values() const {
  std::map<std::string, std::map<std::string, std::string>> result;
  for (const auto& [section, entries] : entries_) {
    for (const auto& entry : entries) result[section][entry.key] = entry.get();
  }
  return result;
}

void Params::print(std::ostream& out, Keys keys) const {
  if (keys != Keys::kExpert) printKeys(out, true);
  if (keys != Keys::kUser) printKeys(out, false);
}

void Params::printKeys(std::ostream& out, bool user) const {
  for (const auto& section : section_order_) {
    bool has_heading = false;
    for (const auto& entry : entries_.at(section)) {
      if (entry.is_user != user) continue;
      if (!has_heading) out << "[" << section << "]\n";
      has_heading = true;
      out << "# " << entry.meaning << "\n" << entry.key << " = " << entry.get() << "\n\n";
    }
  }
}

}  // namespace headway
