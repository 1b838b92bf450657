// Bars by robot and library on a logarithmic scale, as SVG.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace dyn::benchmark::peers {

class Chart {
 public:
  explicit Chart(std::string task) : task_(std::move(task)) {}
  void add(const std::string& robot, const std::string& library, double ns);
  /// Writes DIRECTORY/TASK.svg and returns its path. Throws Error(file).
  std::string write(const std::string& directory) const;

 private:
  std::string task_;
  std::vector<std::string> robots_, libraries_;
  std::map<std::pair<std::string, std::string>, double> ns_;
};

}  // namespace dyn::benchmark::peers
