// Which paths hit something: every path at POINTS points, by Coal, with the meshes and primitives of the job.
//
// usage: hits JOB POINTS [every]
// The job has lines of words:
//   joint PARENT r|p AXIS(3) POSE(12) REACH   joints from 1 on, 0 is the world; REACH: no point of the robot is ever farther away
//   body JOINT POSE(12) SHAPE                 of the robot, or with joint 0 a solid of the cell
//   cell                                      a new problem: the robot alone
//   pair A B                                  bodies from 0 on, in their order
//   path STATES, then a line for each state: a number per joint
// SHAPE is `box X Y Z`, `sphere R`, `cylinder R LENGTH`, `capsule R LENGTH` or `mesh CORNERS TRIANGLES` with their numbers.
// A POSE is three rows of a 3x4 matrix. Printed for each path: `free`, or `hit FRACTION A B`.
// With 1 for POINTS a path is its first state.
// Every point counts, but without the word `every` not every pair is asked at every point: where its distance at one is d, it
// is free at those that follow as long as no point of the two can have moved by d.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <memory>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include <coal/BVH/BVH_model.h>
#include <coal/collision.h>
#include <coal/distance.h>
#include <coal/shape/geometric_shapes.h>

using coal::Matrix3s;
using coal::Transform3s;
using coal::Vec3s;
using State = std::vector<double>;

// Where boxes are farther apart than this, their gap serves as the distance.
constexpr double APART = 0.02;
// Above what Coal leaves undecided in a distance.
constexpr double UNDECIDED = 1e-5;

struct Joint {
  int parent;
  bool prismatic;
  Vec3s axis;
  Transform3s placement;
  double reach;
};

struct Collider {
  int joint;
  Transform3s placement;
  std::shared_ptr<coal::CollisionGeometry> shape;
  Vec3s middle, half;
};

struct Pair {
  int a, b;
  coal::ComputeCollision touch;
  coal::ComputeDistance measure;
  double free = 0;  // how far the two may still move
};

static Transform3s read_pose(std::istream& in) {
  Matrix3s rotation;
  Vec3s shift;
  for (int row = 0; row < 3; ++row) in >> rotation(row, 0) >> rotation(row, 1) >> rotation(row, 2) >> shift[row];
  return {rotation, shift};
}

static Collider collider(int joint, const Transform3s& placement, std::shared_ptr<coal::CollisionGeometry> shape) {
  shape->computeLocalAABB();
  const auto& box = shape->aabb_local;
  return {joint, placement, shape, (box.max_ + box.min_) / 2, (box.max_ - box.min_) / 2};
}

static std::shared_ptr<coal::CollisionGeometry> read_mesh(std::istream& in) {
  std::size_t corners, triangles;
  in >> corners >> triangles;
  std::vector<Vec3s> points(corners);
  for (auto& p : points) in >> p[0] >> p[1] >> p[2];
  std::vector<coal::Triangle> rows;
  for (std::size_t k = 0; k < triangles; ++k) {
    std::size_t a, b, c;
    in >> a >> b >> c;
    rows.emplace_back(a, b, c);
  }
  auto mesh = std::make_shared<coal::BVHModel<coal::OBBRSS>>();
  mesh->beginModel(unsigned(triangles), unsigned(corners));
  mesh->addSubModel(points, rows);
  mesh->endModel();
  return mesh;
}

static std::shared_ptr<coal::CollisionGeometry> read_shape(std::istream& in) {
  std::string kind;
  in >> kind;
  if (kind == "mesh") return read_mesh(in);
  double x, y, z;
  in >> x;
  if (kind == "sphere") return std::make_shared<coal::Sphere>(x);
  in >> y;
  if (kind == "cylinder") return std::make_shared<coal::Cylinder>(x, y);
  if (kind == "capsule") return std::make_shared<coal::Capsule>(x, y);
  in >> z;
  return std::make_shared<coal::Box>(x, y, z);
}

class Cell {
 public:
  std::vector<Joint> joints;
  std::vector<Collider> bodies;
  std::vector<Pair> pairs;
  std::size_t links = 0;
  bool only_touching = false;  // distances help only where another point follows

  void clear() {
    pairs.clear();
    if (links == 0) links = bodies.size();
    bodies.resize(links, bodies.front());
  }

  void add_pair(int a, int b) {
    const auto *first = bodies.at(std::size_t(a)).shape.get(), *second = bodies.at(std::size_t(b)).shape.get();
    pairs.push_back({a, b, {first, second}, {first, second}});
  }

  // Takes a step's motion off what the pairs are free for; true where one has to be asked.
  bool move(const State& from, const State& to) {
    moved_.assign(1, 0);
    for (std::size_t i = 0; i < joints.size(); ++i)
      moved_.push_back(moved_[std::size_t(joints[i].parent)] + std::fabs(to[i] - from[i]) * joints[i].reach);
    bool any = false;
    for (auto& pair : pairs) {
      pair.free -= moved_[std::size_t(bodies[std::size_t(pair.a)].joint)] + moved_[std::size_t(bodies[std::size_t(pair.b)].joint)];
      any = any || pair.free <= 0;
    }
    return any;
  }

  void forget() {
    for (auto& pair : pairs) pair.free = 0;
  }

  void place(const State& q) {
    std::vector<Transform3s> frames{Transform3s()};
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const auto& joint = joints[i];
      const Transform3s turned(Eigen::AngleAxisd(q[i], joint.axis).toRotationMatrix(), Vec3s::Zero());
      const Transform3s pushed(Matrix3s::Identity(), Vec3s(q[i] * joint.axis));
      frames.push_back(frames[std::size_t(joint.parent)] * joint.placement * (joint.prismatic ? pushed : turned));
    }
    poses_.clear();
    middles_.clear();
    halves_.clear();
    for (const auto& body : bodies) {
      const Transform3s pose = frames[std::size_t(body.joint)] * body.placement;
      poses_.push_back(pose);
      middles_.push_back(pose.transform(body.middle));
      halves_.push_back(pose.getRotation().cwiseAbs() * body.half);
    }
  }

  // The first pair that touches at the state placed last, or null; only those are asked that are free no longer.
  const Pair* touching() {
    for (auto& pair : pairs) {
      if (pair.free > 0) continue;
      const auto a = std::size_t(pair.a), b = std::size_t(pair.b);
      const Vec3s apart = (middles_[a] - middles_[b]).cwiseAbs() - halves_[a] - halves_[b];
      pair.free = apart.cwiseMax(0.0).norm() - UNDECIDED;
      if (pair.free > APART) continue;
      collision_.clear();
      if (apart.maxCoeff() <= UNDECIDED && pair.touch(poses_[a], poses_[b], collision_request_, collision_) > 0) return &pair;
      if (only_touching) continue;
      distance_.clear();
      pair.free = pair.measure(poses_[a], poses_[b], distance_request_, distance_) - UNDECIDED;
    }
    return nullptr;
  }

  Cell() { distance_request_.enable_signed_distance = false; }

 private:
  std::vector<Transform3s> poses_;
  std::vector<Vec3s> middles_, halves_;
  std::vector<double> moved_;
  coal::CollisionRequest collision_request_{coal::NO_REQUEST, 1};
  coal::CollisionResult collision_;
  coal::DistanceRequest distance_request_;
  coal::DistanceResult distance_;
};

// Points along the polyline, evenly by joint length, both ends among them.
static std::vector<State> spread(const std::vector<State>& states, std::size_t count) {
  std::vector<double> at{0};
  for (std::size_t i = 1; i < states.size(); ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < states[i].size(); ++k) sum += std::pow(states[i][k] - states[i - 1][k], 2);
    at.push_back(at.back() + std::sqrt(sum));
  }
  if (at.back() == 0) return {states.front()};
  std::vector<State> points;
  std::size_t i = 1;
  for (std::size_t n = 0; n < count; ++n) {
    const double here = at.back() * double(n) / double(count - 1);
    while (i + 1 < at.size() && at[i] < here) ++i;
    const double step = at[i] - at[i - 1], part = step > 0 ? std::min(1.0, (here - at[i - 1]) / step) : 1.0;
    State q = states[i - 1];
    for (std::size_t k = 0; k < q.size(); ++k) q[k] += part * (states[i][k] - q[k]);
    points.push_back(q);
  }
  return points;
}

static void check(Cell& cell, const std::vector<State>& states, std::size_t count, bool every) {
  const auto points = spread(states, count);
  cell.forget();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (every) cell.forget();
    if (i > 0 && !cell.move(points[i - 1], points[i])) continue;
    cell.place(points[i]);
    if (const Pair* pair = cell.touching()) {
      std::cout << "hit " << double(i) / std::max<double>(1, double(points.size() - 1)) << ' ' << pair->a << ' ' << pair->b << '\n';
      return;
    }
  }
  std::cout << "free\n";
}

static std::vector<State> read_path(std::istream& in, std::size_t joints) {
  std::size_t count;
  in >> count;
  std::vector<State> states(count, State(joints));
  for (auto& state : states)
    for (auto& x : state) in >> x;
  return states;
}

int main(int count, char** words) {
  if (count < 3) {
    std::cerr << "usage: hits JOB POINTS [every]\n";
    return 2;
  }
  std::ifstream in(words[1]);
  const std::size_t points = std::stoul(words[2]);
  Cell cell;
  cell.only_touching = points == 1;
  for (std::string word; in >> word;) {
    if (word == "joint") {
      Joint joint;
      std::string kind;
      in >> joint.parent >> kind >> joint.axis[0] >> joint.axis[1] >> joint.axis[2];
      joint.prismatic = kind == "p";
      joint.placement = read_pose(in);
      in >> joint.reach;
      cell.joints.push_back(joint);
    } else if (word == "body") {
      int joint;
      in >> joint;
      const auto placement = read_pose(in);
      cell.bodies.push_back(collider(joint, placement, read_shape(in)));
    } else if (word == "cell") {
      cell.clear();
    } else if (word == "pair") {
      int a, b;
      in >> a >> b;
      cell.add_pair(a, b);
    } else if (word == "path") {
      check(cell, read_path(in, cell.joints.size()), points, count > 3);
    } else {
      std::cerr << "the job says `" << word << "`\n";
      return 2;
    }
  }
}
