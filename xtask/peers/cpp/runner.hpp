// What the C++ runners share: files, the two arms, cells, and the conversation with xtask. No library under test here.
#pragma once
#include <time.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace peers {

using Point = std::array<double, 3>;

struct Mesh {
  std::vector<Point> vertices;
  std::vector<std::array<int, 3>> triangles;
  Point low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  double extent() const { return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}); }
};

inline std::vector<char> read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + path);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline bool there(const std::string& path) { return std::ifstream(path).good(); }

template <class T>
T at(const std::vector<char>& bytes, size_t offset) {
  T value;
  if (offset + sizeof value > bytes.size()) throw std::runtime_error("a file ends too early");
  std::memcpy(&value, &bytes[offset], sizeof value);
  return value;
}

// Vertices of equal coordinates become one.
inline Mesh read_mesh(const std::string& path) {
  const auto bytes = read_file(path);
  const auto count = at<uint32_t>(bytes, 80);
  Mesh mesh;
  std::map<std::array<float, 3>, int> known;
  for (size_t t = 0; t < count; ++t) {
    std::array<int, 3> triangle;
    for (size_t corner = 0; corner < 3; ++corner) {
      const size_t from = 84 + 50 * t + 12 + 12 * corner;
      const std::array<float, 3> p{at<float>(bytes, from), at<float>(bytes, from + 4), at<float>(bytes, from + 8)};
      const auto [entry, fresh] = known.try_emplace(p, int(mesh.vertices.size()));
      if (fresh) {
        mesh.vertices.push_back({p[0], p[1], p[2]});
        for (int k = 0; k < 3; ++k) {
          mesh.low[k] = std::min(mesh.low[k], double(p[k]));
          mesh.high[k] = std::max(mesh.high[k], double(p[k]));
        }
      }
      triangle[corner] = entry->second;
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

// Twelve numbers a body: the rotation's rows, then the translation.
struct Poses {
  int records = 0, bodies = 0;
  std::vector<double> numbers;
  const double* of(int record, int body) const { return &numbers[(size_t(record) * bodies + body) * 12]; }
};

inline Poses read_poses(const std::string& path) {
  const auto bytes = read_file(path);
  Poses poses;
  poses.records = int(at<uint32_t>(bytes, 4));
  poses.bodies = int(at<uint32_t>(bytes, 8));
  poses.numbers.resize(size_t(poses.records) * poses.bodies * 12);
  if (bytes.size() != 12 + poses.numbers.size() * 8) throw std::runtime_error(path + ": length is not what its head says");
  std::memcpy(poses.numbers.data(), &bytes[12], poses.numbers.size() * 8);
  return poses;
}

struct Meta {
  double size = 0, tolerance = 0;
};

inline Meta read_meta(const std::string& path) {
  Meta meta;
  std::ifstream(path) >> meta.size >> meta.tolerance;
  return meta;
}

inline double processor_ns() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) * 1e9 + double(t.tv_nsec);
}

// One question on one set. `pass` holds the whole loop, so that the question itself can be inlined into it.
struct Cell {
  std::string lib, set, query;
  int records;
  double size, tolerance;
  std::function<double(int)> answer;
  std::function<double(int, int)> pass;
};

inline std::vector<Cell>& cells() {
  static std::vector<Cell> all;
  return all;
}

template <class F>
void add(const std::string& lib, const std::string& set, const std::string& query, int records, Meta meta, F ask) {
  auto pass = [ask](int count, int passes) mutable {
    double sum = 0;
    for (int p = 0; p < passes; ++p)
      for (int i = 0; i < count; ++i) sum += ask(i);
    return sum;
  };
  cells().push_back({lib, set, query, records, meta.size, meta.tolerance, ask, pass});
}

inline double time_of(Cell& cell, int records, int passes) {
  double sum = 0;
  const double warm_up = processor_ns();
  for (int i = 0; i < records && processor_ns() - warm_up < 1e6; ++i) sum += cell.answer(i);
  const double start = processor_ns();
  sum += cell.pass(records, passes);
  const double spent = processor_ns() - start;
  volatile double sink = sum;
  (void)sink;
  return spent / std::max(1.0, double(records) * passes);
}

// Lists the cells, then obeys `time CELL RECORDS PASSES` and `answers CELL FROM COUNT FILE` until the input ends.
inline void serve() {
  std::cout.precision(17);
  for (const auto& c : cells())
    std::cout << "cell " << c.lib << ' ' << c.set << ' ' << c.query << ' ' << c.records << ' ' << c.size << ' ' << c.tolerance << '\n';
  std::cout << "ready" << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream words(line);
    std::string verb, file;
    int index = -1, first = 0, second = 0;
    words >> verb >> index >> first >> second >> file;
    auto& cell = cells().at(size_t(index));
    if (verb == "time") {
      std::cout << time_of(cell, std::min(first, cell.records), second) << std::endl;
    } else {
      const int end = std::min(cell.records, first + second);
      std::ofstream out(file, std::ios::binary);
      for (int i = first; i < end; ++i) {
        const double value = cell.answer(i);
        out.write(reinterpret_cast<const char*>(&value), sizeof value);
      }
      out.close();
      std::cout << end - first << std::endl;
    }
  }
}

// ---- Two arms: boxes of the links in the world decide which pairs are asked for.

constexpr int LINKS = 7;
constexpr double ARM_TOLERANCE = 0.05;
constexpr int PATH_STEPS = 200;

struct Box {
  double low[3], high[3];
};

inline Box placed(const Mesh& mesh, const double* pose) {
  Box box;
  for (int i = 0; i < 3; ++i) {
    double middle = pose[9 + i], half = 0;
    for (int k = 0; k < 3; ++k) {
      middle += pose[3 * i + k] * 0.5 * (mesh.low[k] + mesh.high[k]);
      half += std::fabs(pose[3 * i + k]) * 0.5 * (mesh.high[k] - mesh.low[k]);
    }
    box.low[i] = middle - half;
    box.high[i] = middle + half;
  }
  return box;
}

struct Boxes {
  Box a[LINKS], b[LINKS];
  Boxes(const std::vector<Mesh>& links, const Poses& poses, int record) {
    for (int k = 0; k < LINKS; ++k) {
      a[k] = placed(links[k], poses.of(record, k));
      b[k] = placed(links[k], poses.of(record, LINKS + k));
    }
  }
};

inline bool apart(const Box& a, const Box& b, double margin) {
  for (int k = 0; k < 3; ++k)
    if (a.low[k] - b.high[k] > margin || b.low[k] - a.high[k] > margin) return true;
  return false;
}

inline double gap_squared(const Box& a, const Box& b) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double gap = std::max({0.0, a.low[k] - b.high[k], b.low[k] - a.high[k]});
    sum += gap * gap;
  }
  return sum;
}

// `close(a, b)` until it says yes, for pairs whose boxes are within `margin`.
template <class F>
bool any_close(const std::vector<Mesh>& links, const Poses& poses, int record, double margin, F close) {
  const Boxes boxes(links, poses, record);
  for (int a = 0; a < LINKS; ++a)
    for (int b = 0; b < LINKS; ++b)
      if (!apart(boxes.a[a], boxes.b[b], margin) && close(a, b)) return true;
  return false;
}

// Least of `nearest(a, b)`, nearest boxes first, as long as a pair's boxes are nearer than what is known.
template <class F>
double least(const std::vector<Mesh>& links, const Poses& poses, int record, F nearest) {
  const Boxes boxes(links, poses, record);
  struct Entry {
    double gap;
    int a, b;
  } order[LINKS * LINKS];
  for (int k = 0; k < LINKS * LINKS; ++k) order[k] = {gap_squared(boxes.a[k / LINKS], boxes.b[k % LINKS]), k / LINKS, k % LINKS};
  std::sort(std::begin(order), std::end(order), [](const Entry& x, const Entry& y) { return x.gap < y.gap; });
  double best = std::numeric_limits<double>::infinity();
  for (const auto& e : order) {
    if (best <= 0 || e.gap >= best * best) break;
    best = std::min(best, nearest(e.a, e.b));
  }
  return best;
}

inline std::vector<Mesh> read_links(const std::string& data) {
  std::vector<Mesh> links;
  for (int k = 0; k < LINKS; ++k) links.push_back(read_mesh(data + "/robot_link" + std::to_string(k) + ".stl"));
  return links;
}

inline Meta arm_meta(const std::vector<Mesh>& links) {
  Meta meta{0, ARM_TOLERANCE};
  for (const auto& link : links) meta.size = std::max(meta.size, link.extent());
  return meta;
}

struct Set {
  std::string name, file;
};

inline std::vector<Set> pair_sets(const std::string& tag, const std::string& data, const std::string& extra) {
  std::vector<Set> sets;
  for (std::string band : {"touch", "near", "far", "random", "near_path", "far_path"}) {
    const bool ours = band == "touch" || band == "near" || band == "far";
    const std::string name = tag + "_" + band, file = (ours ? data : extra) + "/" + name + ".pose";
    if (there(file)) sets.push_back({name, file});
  }
  return sets;
}

inline std::vector<Set> arm_sets(const std::string& data) {
  std::vector<Set> sets;
  for (std::string name : {"0.6", "1.0", "1.4", "1.8", "2.2", "hard"}) {
    const std::string set = "robots_" + name, file = data + "/" + set + ".pose";
    if (there(file)) sets.push_back({set, file});
  }
  return sets;
}

inline bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// `add_all(data, extra)` makes the cells.
template <class F>
int run(int count, char** words, F add_all) {
  if (count != 3) {
    std::cerr << "usage: RUNNER DIR EXTRA\n";
    return 2;
  }
  try {
    add_all(std::string(words[1]), std::string(words[2]));
    serve();
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 2;
  }
  return 0;
}

}  // namespace peers
