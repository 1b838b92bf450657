// SPDX-License-Identifier: BSD-2-Clause
#include "worker.hpp"

#include "interrupt.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyn::tool::sweep {

Worker::Worker(const Setting& setting) : setting_(setting), task_(makeTask(setting)), fields_{{"failed", {}, true}, {"success", {}, true}} {
  if (setting.study.keeps("inputs"))
    for (const Quantity& quantity : setting.variation.quantities()) {
      fields_.push_back({"input/" + quantity.name, {quantity.size}});
      inputs_ += static_cast<std::size_t>(quantity.size);
    }
  fields_.insert(fields_.end(), task_->fields().begin(), task_->fields().end());
  constexpr std::size_t most_numbers = std::size_t{1} << 26;
  if (numbersOf(fields_) > most_numbers)
    throw Error(ErrorCode::argument, "the results of one sample take more than 512 MB; keep less, or give a larger 'every'",
                {setting.study.name, 0, ""});
  constexpr std::size_t block_numbers = std::size_t{1} << 17;
  const std::size_t fitting = std::max<std::size_t>(block_numbers / numbersOf(fields_), 1);
  together_ = static_cast<std::int64_t>(std::min(task_->together(), fitting));
  readSuccess();
}

void Worker::readSuccess() {
  if (!setting_.study.document.contains("success")) return;
  const json::Value success = setting_.study.value()["success"];
  success.eachMember([&](const std::string& name, const json::Value& value) {
    std::size_t first = 0;
    const auto field = std::find_if(fields_.begin(), fields_.end(), [&](const Field& f) {
      if (f.name == name) return true;
      first += f.size();
      return false;
    });
    if (field == fields_.end()) unknownName(success, "kept result", name, namesOf(fields_));
    std::vector<json::Value> ends;
    value.each([&](const json::Value& end) { ends.push_back(end); });
    if (ends.size() != 2) value.fail("must be [low, high]");
    const int size = static_cast<int>(field->size());
    bounds_.push_back({first, readNumbers(ends[0], size), readNumbers(ends[1], size)});
  });
}

void Worker::prepare() {
  try {
    task_->prepare();
  } catch (const std::exception&) {
    if (!Interruption::pending()) throw;
  }
}

std::vector<std::optional<std::string>> Worker::samples(std::int64_t first, std::int64_t count, double* rows) {
  const std::size_t size = numbersOf(fields_), head = 2 + inputs_;
  std::vector<std::optional<std::string>> reasons(static_cast<std::size_t>(count));
  std::fill(rows, rows + size * reasons.size(), std::numeric_limits<double>::quiet_NaN());
  prepare();
  std::vector<Inputs> drawn;
  std::vector<double*> results;
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < reasons.size(); ++k) {
    try {
      drawn.push_back(setting_.variation.draw(static_cast<std::uint64_t>(first) + k));
      std::copy_n(drawn.back().values.begin(), inputs_, rows + size * k + 2);
      results.push_back(rows + size * k + head);
      places.push_back(k);
    } catch (const std::exception& e) {
      reasons[k] = e.what();
    }
  }
  std::vector<std::optional<std::string>> found = task_->runAll(drawn, results);
  for (std::size_t k = 0; k < places.size(); ++k) reasons[places[k]] = std::move(found[k]);
  for (std::size_t k = 0; k < reasons.size(); ++k) reasons[k] = finish(std::move(reasons[k]), rows + size * k);
  return reasons;
}

std::optional<std::string> Worker::finish(std::optional<std::string> reason, double* row) const {
  double* const results = row + 2 + inputs_;
  const double* number = row;
  for (const Field& field : fields_) {
    const double* const end = number + field.size();
    if (number >= row + 2 && !reason && !std::all_of(number, end, [](double x) { return std::isfinite(x); })) reason = field.name + " is not finite";
    number = end;
  }
  row[0] = reason.has_value();
  row[1] = !reason && std::all_of(bounds_.begin(), bounds_.end(), [&](const Bound& bound) {
    for (std::size_t k = 0; k < bound.low.size(); ++k)
      if (!(row[bound.first + k] >= bound.low[k] && row[bound.first + k] <= bound.high[k])) return false;
    return true;
  });
  if (reason) {
    double* result = results;
    for (const Field& field : task_->fields()) {
      // A byte has no NaN.
      std::fill_n(result, field.size(), field.flag ? 0.0 : std::numeric_limits<double>::quiet_NaN());
      result += field.size();
    }
  }
  return reason;
}

std::optional<Chunk> Worker::chunk(std::int64_t first, std::int64_t count) {
  constexpr std::size_t longest_reason = 1000;
  const std::size_t row_size = numbersOf(fields_);
  Chunk out{first, count, {}, {}};
  out.numbers.resize(row_size * static_cast<std::size_t>(count));
  std::vector<double> rows(row_size * static_cast<std::size_t>(together_));
  for (std::int64_t begin = 0; begin < count; begin += together_) {
    if (Interruption::pending()) return {};
    const std::int64_t n = std::min(together_, count - begin);
    const std::vector<std::optional<std::string>> reasons = samples(first + begin, n, rows.data());
    if (Interruption::pending()) return {};  // which can be why some failed
    for (std::int64_t k = 0; k < n; ++k) {
      if (const std::optional<std::string>& reason = reasons[static_cast<std::size_t>(k)])
        out.failures.push_back({first + begin + k, reason->substr(0, longest_reason)});
      const double* from = rows.data() + row_size * static_cast<std::size_t>(k);
      double* column = out.numbers.data();
      for (const Field& field : fields_) {
        const std::size_t size = field.size();
        std::copy_n(from, size, column + size * static_cast<std::size_t>(begin + k));
        from += size;
        column += size * static_cast<std::size_t>(count);
      }
    }
  }
  return out;
}

}  // namespace dyn::tool::sweep
