// SPDX-License-Identifier: BSD-2-Clause
// Charts: no text is cut off, and no two texts overlap.
#include "support/catch.hpp"

#include <report/bar_chart.hpp>
#include <report/labels.hpp>
#include <report/line_chart.hpp>

#include <cmath>

using namespace dyn;
using namespace dyn::benchmark;

TEST_CASE("marks of axes are round numbers", "[report]") {
  for (const double most : {2762.0, 1381.0, 0.0137, 9.99e8}) {
    for (const Axis& axis : {barAxis(most / 10, most, Scale::linear), lineAxis(-most, most, Scale::linear)}) {
      CHECK(axis.fraction(most) <= 1);
      CHECK(axis.marks.size() < 13);
      for (const Mark& mark : axis.marks) {
        const double power = std::pow(10, std::floor(std::log10(most)) - 1), multiple = mark.value / power;
        INFO(most << " " << mark.value);
        CHECK(std::fabs(multiple - std::round(multiple)) < 1e-6);
      }
    }
  }
}

TEST_CASE("names that would lie over each other are moved apart, and stay in order", "[report]") {
  const std::vector<double> wanted{10, 11, 12, 100, 50, 99}, places = spread(wanted, 14, 0, 110);
  for (std::size_t a = 0; a < wanted.size(); ++a)
    for (std::size_t b = 0; b < wanted.size(); ++b) {
      if (wanted[a] < wanted[b]) CHECK(places[b] - places[a] >= 14 - 1e-9);
      CHECK(places[a] <= 110);
    }
}

TEST_CASE("a label takes the first place that is free and within the picture, or none", "[report]") {
  FreeSpace space({0, 0, 100, 100});
  CHECK(space.takeFirst({{90, 10, 20, 10}, {70, 10, 20, 10}}) == 1);
  CHECK(space.takeFirst({{75, 12, 20, 10}, {70, 30, 20, 10}}) == 1);
  CHECK(space.takeFirst({{75, 12, 20, 10}, {-1, 0, 10, 10}}) == -1);
}

TEST_CASE("long titles and names are within the picture", "[report]") {
  CHECK(wrapped("one two three", 10, 50).size() == 2);
  std::string title(81, 'w');
  title[40] = ' ';
  LineChart chart(title, {"x"}, {"y"});
  for (const char* name : {"a name of a series that is rather long for a legend", "another name that is as long, or even longer than that"}) {
    chart.add(name, 0, 0);
    chart.add(name, 1, 1);
  }
  const std::string svg = chart.svg();
  // The names are in one column, the second below the first.
  const auto placeOf = [&](const std::string& name) { return svg.substr(svg.rfind("<text", svg.rfind(name)), 40); };
  CHECK_THAT(placeOf("a name of"), test::containing("x=\"100\""));
  CHECK_THAT(placeOf("another"), test::containing("x=\"100\""));
  BarChart bars("title", Scale::linear);
  bars.add("group", "series", {1, 2, 3});
  CHECK_THAT(bars.svg(), test::containing("<path"));
}
