// SPDX-License-Identifier: BSD-2-Clause
// MuJoCo reads binary STL and OBJ. libdyn_geometry reads more by assimp, but programs that load models should not need to link it.
#include "mesh.hpp"

#include <dyn/file.hpp>

#include <charconv>
#include <cmath>
#include <cstring>

namespace dyn::mjcf {

namespace {

constexpr std::uintmax_t largest_mesh = std::uintmax_t{128} << 20;

class MeshReader {
 public:
  explicit MeshReader(const std::string& path) : path_(path), bytes_(readFile(path, largest_mesh)) {}

  geometry::TriangleMesh run() {
    std::string ending = path_.size() > 4 ? path_.substr(path_.size() - 4) : "";
    for (char& c : ending) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    if (ending == ".stl") {
      stl();
    } else if (ending == ".obj") {
      obj();
    } else {
      refuse("has a mass that is not computed: only those of .stl and .obj files are; give the body an <inertial>");
    }
    if (mesh_.triangles.empty()) refuse("has no triangles");
    for (const Vec3<double>& x : mesh_.vertices)
      if (!std::isfinite(x.x) || !std::isfinite(x.y) || !std::isfinite(x.z)) refuse("has a vertex that is not finite");
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void refuse(const std::string& why, int line = 0) const { throw Error(ErrorCode::syntax, why, {path_, line, ""}); }

  /// A header of 80 bytes, the number of triangles, and 50 bytes for each: a normal, three corners, two bytes of attributes.
  void stl() {
    std::uint32_t count = 0;
    if (bytes_.size() >= 84) std::memcpy(&count, bytes_.data() + 80, 4);
    if (bytes_.size() < 84 || (bytes_.size() - 84) / 50 < count)
      refuse(bytes_.starts_with("solid") ? "is an STL of text; save it as a binary one" : "is no binary STL, or is cut off");
    for (std::uint32_t i = 0; i < count; ++i) {
      float x[9];
      std::memcpy(x, bytes_.data() + 84 + std::size_t{50} * i + 12, sizeof x);
      const int first = static_cast<int>(mesh_.vertices.size());
      for (int k = 0; k < 9; k += 3) mesh_.vertices.push_back({x[k], x[k + 1], x[k + 2]});
      mesh_.triangles.push_back({first, first + 1, first + 2});
    }
  }

  /// Lines "v x y z" and "f a b c ...", where a corner is an index from 1 or, from the end, a negative one; "a/b/c" has it first.
  void obj() {
    int line = 0;
    for (std::size_t begin = 0; begin < bytes_.size();) {
      const std::size_t end = std::min(bytes_.find('\n', begin), bytes_.size());
      const std::string_view text(bytes_.data() + begin, end - begin);
      begin = end + 1;
      ++line;
      if (text.starts_with("v ") || text.starts_with("v\t")) vertex(text.substr(2), line);
      if (text.starts_with("f ") || text.starts_with("f\t")) face(text.substr(2), line);
    }
  }

  /// Removes the next word from a text.
  static std::string_view next(std::string_view& text) {
    const char* blanks = " \t\r";
    const std::size_t begin = std::min(text.find_first_not_of(blanks), text.size());
    const std::size_t end = std::min(text.find_first_of(blanks, begin), text.size());
    const std::string_view word = text.substr(begin, end - begin);
    text.remove_prefix(end);
    return word;
  }

  void vertex(std::string_view text, int line) {
    Vec3<double> x;
    for (int k = 0; k < 3; ++k) {
      const std::string_view word = next(text);
      if (std::from_chars(word.data(), word.data() + word.size(), x[k]).ec != std::errc()) refuse("has a vertex without three numbers", line);
    }
    mesh_.vertices.push_back(x);
  }

  void face(std::string_view text, int line) {
    const auto count = static_cast<long>(mesh_.vertices.size());
    int corners[3], known = 0;
    for (std::string_view word = next(text); !word.empty(); word = next(text)) {
      long index = 0;
      if (std::from_chars(word.data(), word.data() + word.size(), index).ec != std::errc())
        refuse("has a face with a corner that is no number", line);
      index = index < 0 ? count + index : index - 1;
      if (index < 0 || index >= count) refuse("has a face with a vertex that does not come before it", line);
      // A polygon is a fan about its first corner.
      if (known == 3) corners[1] = corners[2];
      corners[known < 3 ? known++ : 2] = static_cast<int>(index);
      if (known == 3) mesh_.triangles.push_back({corners[0], corners[1], corners[2]});
    }
    if (known < 3) refuse("has a face of less than three corners", line);
  }

  std::string path_, bytes_;
  geometry::TriangleMesh mesh_;
};

}  // namespace

geometry::TriangleMesh readTriangles(const std::string& path) { return MeshReader(path).run(); }

}  // namespace dyn::mjcf
