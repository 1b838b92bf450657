// SPDX-License-Identifier: BSD-2-Clause
// Random models in MJCF: trees of bodies with every joint type, several joints a body, every spelling of orientations, nested classes of defaults,
// geoms of every shape with mass or density, and inertials. MuJoCo 2.2.2 reads them, too.
#pragma once

#include <cstdint>
#include <random>
#include <sstream>
#include <string>

namespace dyn::test {

class RandomMjcf {
 public:
  /// Several geoms of a body have mass only if `diagonalised`, and inertials may be full then: MuJoCo diagonalises such inertias, with an error.
  explicit RandomMjcf(std::uint64_t seed, bool diagonalised = true) : random_(seed), degrees_(pick(2)), diagonalised_(diagonalised) {}

  std::string text() {
    const char* sequences[] = {"xyz", "XYZ", "zyx", "ZYX", "xYz", "zxz", "ZXz", "yzx"};
    out_.precision(17);
    out_ << "<mujoco model=\"random\">\n<compiler eulerseq=\"" << sequences[pick(8)] << "\"/>\n<compiler angle=\"" << (degrees_ ? "degree" : "radian")
         << "\" autolimits=\"true\"" << (pick(4) == 0 ? " inertiafromgeom=\"true\"" : "") << (pick(4) == 0 ? " boundinertia=\"0.01\"" : "")
         << (pick(4) == 0 ? " boundmass=\"0.05\"" : "") << (pick(3) == 0 ? " settotalmass=\"7\"" : "") << "/>\n";
    out_ << "<option gravity=\"" << vector(5) << "\"/>\n";
    out_ << "<default class=\"all\">\n<joint axis=\"" << direction() << "\" armature=\"" << number(0, 0.1)
         << "\"/>\n<geom size=\"0.1 0.2 0.3\" density=\"" << number(100, 2000)
         << "\"/>\n<default class=\"slim\"><geom type=\"capsule\" size=\"0.02\"/><joint type=\"slide\" ref=\"0.1\"/>"
         << "<default class=\"turned\"><geom euler=\"" << angles() << "\"/><joint type=\"hinge\" ref=\"" << angle() << "\" range=\"" << range()
         << "\"/></default></default>\n<default class=\"ball\"><joint type=\"ball\" pos=\"" << vector(0.2)
         << "\"/><geom type=\"ellipsoid\"/></default>\n</default>\n<worldbody>\n<geom type=\"plane\" size=\"1 1 1\"/>\n<site name=\"corner\" pos=\""
         << vector(1) << "\"/>\n";
    const int trees = 1 + pick(3);
    for (int i = 0; i < trees; ++i) body(0);
    out_ << "</worldbody>\n</mujoco>\n";
    return out_.str();
  }

 private:
  int pick(int n) { return static_cast<int>(random_() % static_cast<std::uint64_t>(n)); }
  double number(double a, double b) { return a + (b - a) * (static_cast<double>(random_() >> 11) * 0x1p-53); }
  std::string text(double x) {
    std::ostringstream s;
    s.precision(17);
    s << x;
    return s.str();
  }
  std::string vector(double size) { return text(number(-size, size)) + " " + text(number(-size, size)) + " " + text(number(-size, size)); }
  std::string direction() { return text(number(0.2, 1)) + " " + text(number(-1, 1)) + " " + text(number(-1, 1)); }
  std::string angle() { return text(number(-2, 2) * (degrees_ ? 57 : 1)); }
  std::string angles() { return angle() + " " + angle() + " " + angle(); }
  std::string range() { return text(number(-2, -1) * (degrees_ ? 57 : 1)) + " " + text(number(1, 2) * (degrees_ ? 57 : 1)); }

  std::string orientation() {
    switch (pick(6)) {
      case 0:
        return " quat=\"" + text(number(0.1, 1)) + " " + vector(1) + "\"";
      case 1:
        return " axisangle=\"" + direction() + " " + angle() + "\"";
      case 2:
        return " xyaxes=\"" + direction() + " " + text(number(-1, 0.1)) + " " + text(number(0.2, 1)) + " " + text(number(-1, 1)) + "\"";
      case 3:
        return " zaxis=\"" + vector(1) + "\"";
      case 4:
        return " euler=\"" + angles() + "\"";
      default:
        return "";
    }
  }
  std::string className() {
    const char* names[] = {"", "", " class=\"slim\"", " class=\"turned\"", " class=\"all\""};
    return names[pick(5)];
  }

  /// Writes a joint. Returns whether it is a ball, which MuJoCo wants to be the last joint of its body.
  bool joint() {
    const int kind = pick(6);
    switch (kind) {
      case 0:
        out_ << "<joint" << className() << "/>\n";
        break;
      case 1:
        out_ << "<joint type=\"slide\" axis=\"" << direction() << "\" ref=\"" << text(number(-1, 1)) << "\"/>\n";
        break;
      case 2:
        out_ << "<joint class=\"ball\"/>\n";
        break;
      case 3:
        out_ << "<joint type=\"hinge\" name=\"j" << ++named_ << "\" pos=\"" << vector(0.3) << "\" axis=\"" << direction() << "\" ref=\"" << angle()
             << "\"/>\n";
        break;
      default:
        out_ << "<joint type=\"hinge\" axis=\"" << direction() << "\" damping=\"1\" stiffness=\"3\"/>\n";
    }
    return kind == 2;
  }

  void geom() {
    const char* types[] = {"sphere", "capsule", "ellipsoid", "cylinder", "box"};
    const int type = pick(5);
    out_ << "<geom";
    if (pick(4) == 0) {
      out_ << className();
      if (pick(2)) out_ << " group=\"7\"";
    } else {
      out_ << " type=\"" << types[type] << "\"";
      if (type > 0 && pick(3) == 0) {
        out_ << " fromto=\"" << vector(0.5) << " " << vector(0.5) << "\" size=\"" << number(0.01, 0.2) << "\"";
      } else {
        out_ << " pos=\"" << vector(0.5) << "\"" << orientation() << " size=\"" << number(0.01, 0.2) << (pick(2) ? " 0.15 0.1\"" : "\"");
      }
    }
    if (!diagonalised_) {
      out_ << " mass=\"0\"";
    } else if (pick(3) == 0) {
      out_ << " mass=\"" << number(0.1, 3) << "\"";
    }
    out_ << "/>\n";
  }

  void body(int depth) {
    out_ << "<body" << (pick(3) ? "" : " name=\"b" + std::to_string(++named_) + "\"") << " pos=\"" << vector(0.7) << "\"" << orientation()
         << (pick(5) ? "" : " childclass=\"slim\"") << ">\n";
    if (depth == 0 && pick(3) == 0) {
      out_ << "<freejoint/>\n";
    } else {
      const int joints = depth == 0 ? 1 + pick(3) : pick(4);
      for (int i = 0; i < joints; ++i)
        if (joint()) break;
    }
    // Every body has mass, which MuJoCo wants of those that move.
    if (pick(4) == 0) {
      const double a = number(0.1, 0.2), b = number(0.1, 0.2), c = number(0.1, 0.2);
      out_ << "<inertial pos=\"" << vector(0.2) << "\" mass=\"" << number(0.1, 4) << "\"";
      if (!diagonalised_ || pick(2)) {
        out_ << " diaginertia=\"" << a << " " << b << " " << c << "\"" << orientation();
      } else {
        out_ << " fullinertia=\"" << a << " " << b << " " << c << " 0.01 -0.02 0.03\"";
      }
      out_ << "/>\n";
    }
    out_ << "<geom type=\"box\" size=\"0.1 0.2 0.15\" pos=\"" << vector(0.1) << "\"/>\n";
    for (int i = pick(3); i > 0; --i) geom();
    if (pick(2)) out_ << "<site name=\"s" << ++named_ << "\" pos=\"" << vector(0.3) << "\"" << orientation() << "/>\n";
    if (depth < 5)
      for (int i = pick(3); i > 0; --i) body(depth + 1);
    out_ << "</body>\n";
  }

  std::mt19937_64 random_;
  bool degrees_, diagonalised_;
  int named_ = 0;
  std::ostringstream out_;
};

}  // namespace dyn::test
