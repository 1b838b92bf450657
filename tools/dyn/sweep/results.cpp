// SPDX-License-Identifier: BSD-2-Clause
#include "results.hpp"

#include "sha256.hpp"

#include <dyn/file.hpp>

#include <filesystem>
#include <fstream>

#ifdef DYN_HAS_HDF5

#include <fcntl.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

namespace dyn::tool::sweep {

namespace {

constexpr std::size_t block_bytes = std::size_t{1} << 24;  ///< that are read at once for a digest
constexpr std::size_t largest_attribute = 60000;           ///< HDF5 has at most 64 KiB

/// An identifier of HDF5, closed with its object.
class Handle {
 public:
  /// Throws Error(file) that says what could not be done.
  Handle(hid_t id, herr_t (*closer)(hid_t), const std::string& file, const char* what) : id_(id), close_(closer) {
    if (id < 0) throw Error(ErrorCode::file, std::string("HDF5 cannot ") + what, {file, 0, ""});
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }
  /// Closes now. Returns false if this fails, for example on a full disk.
  bool close() { return close_(std::exchange(id_, -1)) >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void start() {
  // After a write that failed, HDF5's own clean-up at the end of the process crashes.
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are reported as exceptions, not printed
}

[[noreturn]] void cannotWrite(const std::string& file) { throw Error(ErrorCode::file, "HDF5 cannot write to it; is the disk full?", {file, 0, ""}); }
void require(herr_t answer, const std::string& file) {
  if (answer < 0) cannotWrite(file);
}

class ResultsFile {
 public:
  explicit ResultsFile(std::string path) : path_(std::move(path)), file_(create()) {}

  void attribute(const char* name, const std::string& text) {
    if (text.size() > largest_attribute) return;
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, path_, "make a type"), space(H5Screate(H5S_SCALAR), H5Sclose, path_, "make a space");
    require(H5Tset_size(type, std::max<std::size_t>(text.size(), 1)), path_);
    require(H5Tset_cset(type, H5T_CSET_UTF8), path_);
    const Handle made(H5Acreate2(file_, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, path_, "make an attribute");
    require(H5Awrite(made, type, text.c_str()), path_);
  }

  Handle dataset(const std::string& name, const std::vector<hsize_t>& shape, bool flag) {
    const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, path_, "make a space");
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, path_, "make a list"),
        links(H5Pcreate(H5P_LINK_CREATE), H5Pclose, path_, "make a list");
    require(H5Pset_obj_track_times(creation, false), path_);  // the bytes must not depend on the clock
    require(H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER), path_);
    require(H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY), path_);  // so that the layout is that of the fields
    require(H5Pset_create_intermediate_group(links, 1), path_);
    return {H5Dcreate2(file_, name.c_str(), flag ? H5T_STD_U8LE : H5T_IEEE_F64LE, space, links, creation, H5P_DEFAULT), H5Dclose, path_,
            "make a dataset"};
  }

  /// Writes rows [first, first + count) of a dataset.
  void write(const Handle& dataset, const std::vector<hsize_t>& shape, std::int64_t first, std::int64_t count, const double* numbers) {
    std::vector<hsize_t> start(shape.size()), extent = shape;
    start[0] = static_cast<hsize_t>(first);
    extent[0] = static_cast<hsize_t>(count);
    if (std::find(extent.begin(), extent.end(), 0) != extent.end()) return;
    const Handle memory(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose, path_, "make a space");
    const Handle space(H5Dget_space(dataset), H5Sclose, path_, "find a space");
    require(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr), path_);
    require(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, numbers), path_);
  }

  void close() {
    if (!file_.close()) cannotWrite(path_);
    // HDF5 does not flush to disk, and the chunks are removed after this.
    const int file = open(path_.c_str(), O_RDONLY | O_CLOEXEC);
    const bool flushed = file >= 0 && fsync(file) == 0;
    if (file >= 0) ::close(file);
    if (!flushed) cannotWrite(path_);
  }

 private:
  Handle create() {
    start();
    return {H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose, path_, "create it"};
  }

  std::string path_;
  Handle file_;
};

/// Removes an unfinished file.
struct Unfinished {
  std::string path;
  ~Unfinished() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

void rename(const std::string& from, const std::string& to) {
  std::error_code failed;
  std::filesystem::rename(from, to, failed);
  if (failed) throw Error(ErrorCode::file, "cannot be written: " + failed.message(), {to, 0, ""});
}

/// Adds a dataset and all its numbers. It joins those that are open.
void writeWhole(ResultsFile& file, std::vector<Handle>& open, const std::string& name, const std::vector<hsize_t>& shape,
                const std::vector<double>& numbers) {
  open.push_back(file.dataset(name, shape, false));
  file.write(open.back(), shape, 0, static_cast<std::int64_t>(shape[0]), numbers.data());
}

}  // namespace

void requireResults() {}

void merge(const Store& store, const Manifest& manifest, const std::vector<Field>& fields, const std::vector<double>& times,
           const Variation& variation, std::vector<Histogram> histograms) {
  const Unfinished part{store.results() + ".part"}, lines_part{store.failures() + ".part"};
  ResultsFile file(part.path);
  file.attribute("libdyn_version", manifest.version);
  file.attribute("model_sha256", manifest.model_sha256);
  file.attribute("study", manifest.study.dump());
  std::vector<std::vector<hsize_t>> shapes;
  std::vector<Handle> datasets;
  for (const Field& field : fields) {
    std::vector<hsize_t> shape{static_cast<hsize_t>(manifest.samples)};
    shape.insert(shape.end(), field.shape.begin(), field.shape.end());
    datasets.push_back(file.dataset(field.name, shape, field.flag));
    shapes.push_back(std::move(shape));
  }
  if (!times.empty()) writeWhole(file, datasets, "times", {times.size()}, times);
  std::ofstream lines(lines_part.path);
  for (std::int64_t number = 0; number < manifest.chunks(); ++number) {
    const Chunk chunk = store.read(manifest, number, numbersOf(fields));
    const double* numbers = chunk.numbers.data();
    for (std::size_t k = 0; k < fields.size(); ++k) {
      file.write(datasets[k], shapes[k], chunk.first, chunk.count, numbers);
      for (Histogram& histogram : histograms)
        if (histogram.field == k) histogram.add(numbers, static_cast<std::size_t>(chunk.count));
      numbers += fields[k].size() * static_cast<std::size_t>(chunk.count);
    }
    for (const Failure& failure : chunk.failures) {
      const Json line = {{"sample", failure.sample},
                         {"reason", failure.reason},
                         {"input", variation.json(variation.draw(static_cast<std::uint64_t>(failure.sample)))}};
      lines << line.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) << "\n";
    }
  }
  for (const Histogram& histogram : histograms) {
    const Field& field = fields[histogram.field];
    std::vector<hsize_t> shape(field.shape.begin(), field.shape.end());
    shape.push_back(histogram.bins());
    writeWhole(file, datasets, "histogram/" + field.name + "/counts", shape, histogram.counts);
    shape.back() = 3;
    writeWhole(file, datasets, "histogram/" + field.name + "/outside", shape, histogram.outside);
    writeWhole(file, datasets, "histogram/" + field.name + "/edges", {histogram.edges.size()}, histogram.edges);
  }
  // HDF5 keeps numbers back until a dataset is closed.
  for (Handle& dataset : datasets)
    if (!dataset.close()) cannotWrite(part.path);
  file.close();
  lines.close();
  if (!lines) cannotWrite(lines_part.path);
  rename(lines_part.path, store.failures());
  rename(part.path, store.results());
}

namespace {

void addToDigest(Sha256& hash, hid_t file, const std::string& name, const std::string& path) {
  const Handle dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, path, "open a dataset");
  const Handle space(H5Dget_space(dataset), H5Sclose, path, "find a space"), type(H5Dget_type(dataset), H5Tclose, path, "find a type");
  std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(H5Sget_simple_extent_ndims(space), 0)));
  H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  const bool flag = H5Tequal(type, H5T_STD_U8LE) > 0;
  if (shape.empty() || (!flag && H5Tequal(type, H5T_IEEE_F64LE) <= 0))
    throw Error(ErrorCode::syntax, name + " is no result of a sweep", {path, 0, ""});
  std::string head = name + (flag ? " u8" : " f64");
  std::size_t row = flag ? 1 : sizeof(double);
  for (std::size_t k = 0; k < shape.size(); ++k) {
    head += " " + std::to_string(shape[k]);
    if (k > 0) row *= static_cast<std::size_t>(shape[k]);
  }
  hash.add(head + "\n");
  if (row == 0) return;
  const hsize_t most = std::max<hsize_t>(block_bytes / row, 1);
  std::string bytes;
  for (hsize_t first = 0; first < shape[0]; first += most) {
    std::vector<hsize_t> start(shape.size()), extent = shape;
    start[0] = first;
    extent[0] = std::min(most, shape[0] - first);
    bytes.resize(static_cast<std::size_t>(extent[0]) * row);
    const Handle memory(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose, path, "make a space");
    H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr);
    if (H5Dread(dataset, type, memory, space, H5P_DEFAULT, bytes.data()) < 0) throw Error(ErrorCode::file, "cannot be read", {path, 0, ""});
    hash.add(bytes);
  }
}

}  // namespace

std::string digestOf(const std::string& path) {
  start();
  if (!std::filesystem::exists(path)) throw Error(ErrorCode::file, "does not exist; the sweep is not finished", {path, 0, ""});
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, path, "open it");
  std::vector<std::string> names;
  const auto visit = [](hid_t, const char* name, const H5O_info_t* info, void* all) -> herr_t {
    if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(all)->push_back(name);
    return 0;
  };
  if (H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, visit, &names, H5O_INFO_BASIC) < 0) throw Error(ErrorCode::file, "cannot be read", {path, 0, ""});
  std::sort(names.begin(), names.end());
  Sha256 hash;
  for (const std::string& name : names) addToDigest(hash, file, name, path);
  return hash.digest();
}

}  // namespace dyn::tool::sweep

#else

namespace dyn::tool::sweep {

void requireResults() {
  throw Error(ErrorCode::argument, "this dyn was built without HDF5, which keeps the results of sweeps; install libhdf5-dev and build again");
}
void merge(const Store&, const Manifest&, const std::vector<Field>&, const std::vector<double>&, const Variation&, std::vector<Histogram>) {
  requireResults();
}
std::string digestOf(const std::string&) {
  requireResults();
  return {};
}

}  // namespace dyn::tool::sweep

#endif
