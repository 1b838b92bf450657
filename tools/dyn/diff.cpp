// SPDX-License-Identifier: BSD-2-Clause
// dyn diff: how two models differ. Exit code 1 if they do.
#include "commands.hpp"
#include "messages.hpp"
#include "model_options.hpp"
#include "options.hpp"
#include "states.hpp"

#include <dyn/model/difference.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

namespace dyn::tool {

namespace {

struct DiffOptions {
  ModelOptions model;
  std::string other;
  double tolerance = 1e-9;
  bool json = false;
};

/// A difference in a unit that people use: 0.4 mm, 2 deg, 3 %.
std::string sizeOf(const Difference& d) {
  if (!std::isfinite(d.size)) return "";
  double x = d.size;
  std::string unit = d.unit;
  if (unit == "rad") {
    x *= 180 / M_PI;
    unit = "deg";
  } else if (unit == "1") {
    x *= 100;
    unit = "%";
  } else if (unit == "m" && x < 1) {
    x *= 1000;
    unit = "mm";
  }
  char text[48];
  std::snprintf(text, sizeof text, "%.3g %s", x, unit.c_str());
  return text;
}

/// A text that fits into a column. The number of characters of UTF-8 is not that of bytes; names are rarely anything but ASCII.
std::string shortened(const std::string& text) {
  constexpr std::size_t most = 36;
  return text.size() <= most ? text : text.substr(0, most - 3) + "...";
}

void print(const std::vector<Difference>& found) {
  std::vector<std::array<std::string, 6>> rows{{"TOPIC", "NAME", "WHAT", "A", "B", "DIFFERENCE"}};
  for (const Difference& d : found) rows.push_back({d.topic, shortened(d.name), shortened(d.what), shortened(d.a), shortened(d.b), sizeOf(d)});
  std::array<std::size_t, 6> width{};
  for (const auto& row : rows)
    for (std::size_t k = 0; k < row.size(); ++k) width[k] = std::max(width[k], row[k].size());
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t k = 0; k < row.size(); ++k) line += row[k] + std::string(k + 1 < row.size() ? width[k] - row[k].size() + 2 : 0, ' ');
    line.erase(line.find_last_not_of(' ') + 1);
    std::printf("%s\n", &row == rows.data() ? heading(line).c_str() : line.c_str());
  }
}

void printJson(const DiffOptions& o, const std::vector<Difference>& found) {
  Json out{{"a", o.model.path}, {"b", o.other}, {"tolerance", o.tolerance}, {"equal", found.empty()}, {"differences", Json::array()}};
  for (const Difference& d : found) {
    Json entry{{"topic", d.topic}, {"name", d.name}, {"what", d.what}, {"a", d.a}, {"b", d.b}};
    if (std::isfinite(d.size)) {
      entry["size"] = d.size;
      entry["unit"] = d.unit;
    }
    out["differences"].push_back(std::move(entry));
  }
  std::printf("%s\n", out.dump(1).c_str());
}

void run(const DiffOptions& o) {
  ModelOptions second = o.model;
  second.path = o.other;
  const std::vector<Difference> found = differences(o.model.read(), second.read(), o.tolerance);
  if (o.json) {
    printJson(o, found);
  } else if (found.empty()) {
    std::printf("no differences\n");
  } else {
    print(found);
    std::printf("%zu differences\n", found.size());
  }
  if (!found.empty()) throw ExitCode{1};
}

}  // namespace

void addDiff(CLI::App& app) {
  CLI::App* sub = addCommand(app, "diff", "how two models differ; exit code 1 if they do");
  auto o = std::make_shared<DiffOptions>();
  o->model.mimic = "coupled";  // as for convert, nothing may be lost
  o->model.add(*sub);
  sub->add_option("OTHER", o->other, "the model to compare with; the options hold for both")->type_name("FILE")->required()->check(fileName());
  sub->add_option("--tolerance", o->tolerance, "the largest distance [m, rad], and the largest fraction of other numbers, that is no difference")
      ->check(notNegative())
      ->capture_default_str();
  sub->add_flag("--json", o->json, "as JSON");
  sub->callback([o] { run(*o); });
}

}  // namespace dyn::tool
