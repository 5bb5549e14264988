// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// MRPT's YAML reader does not free libfyaml's parser and events where a text is no YAML: 3 kB a
// file, of which a program reads one. A fuzz target reads a million; it includes this file, whose
// functions take the place of libfyaml's, and frees what is left after each input. libfyaml itself
// then leaves 200 bytes, which no call frees: run.sh checks such targets for leaks at their end,
// not after each input, without libfyaml's.
#include <dlfcn.h>

#include <map>
#include <vector>

namespace headway::test {

using YamlParser = void;
using YamlEvent = void;

/// Parsers that were not destroyed, with their events that were not freed, oldest first.
inline std::map<YamlParser*, std::vector<YamlEvent*>>& yamlParsers() {
  static std::map<YamlParser*, std::vector<YamlEvent*>> parsers;
  return parsers;
}

/// libfyaml's own function of a name.
template <typename Function>
Function* ofLibfyaml(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace headway::test

extern "C" {

__attribute__((used)) inline const char* __lsan_default_suppressions() { return "leak:libfyaml"; }

__attribute__((used)) inline headway::test::YamlParser* fy_parser_create(const void* options) {
  static auto* const create =
      headway::test::ofLibfyaml<headway::test::YamlParser*(const void*)>("fy_parser_create");
  auto* const parser = create(options);
  headway::test::yamlParsers()[parser];
  return parser;
}

__attribute__((used)) inline void fy_parser_destroy(headway::test::YamlParser* parser) {
  static auto* const destroy =
      headway::test::ofLibfyaml<void(headway::test::YamlParser*)>("fy_parser_destroy");
  headway::test::yamlParsers().erase(parser);
  destroy(parser);
}

__attribute__((used)) inline headway::test::YamlEvent* fy_parser_parse(
    headway::test::YamlParser* parser) {
  static auto* const parse =
      headway::test::ofLibfyaml<headway::test::YamlEvent*(headway::test::YamlParser*)>(
          "fy_parser_parse");
  auto* const event = parse(parser);
  if (event != nullptr) headway::test::yamlParsers()[parser].push_back(event);
  return event;
}

__attribute__((used)) inline void fy_parser_event_free(headway::test::YamlParser* parser,
                                                       headway::test::YamlEvent* event) {
  static auto* const release =
      headway::test::ofLibfyaml<void(headway::test::YamlParser*, headway::test::YamlEvent*)>(
          "fy_parser_event_free");
  auto& events = headway::test::yamlParsers()[parser];
  for (std::size_t i = events.size(); i-- > 0;) {
    if (events[i] != event) continue;
    events.erase(events.begin() + static_cast<std::ptrdiff_t>(i));
    break;
  }
  release(parser, event);
}
}

namespace headway::test {

/// Frees the parsers that the reader left.
inline void freeYamlParsers() {
  while (!yamlParsers().empty()) {
    const auto [parser, events] = *yamlParsers().begin();
    for (auto event = events.rbegin(); event != events.rend(); ++event) {
      fy_parser_event_free(parser, *event);
    }
    fy_parser_destroy(parser);
  }
}

}  // namespace headway::test
