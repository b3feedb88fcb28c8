// What both VAMP programs share: the robot, and scenes read from words.
#pragma once
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <vamp/collision/factory.hh>
#include <vamp/planning/validate.hh>
#include <vamp/robots/panda.hh>

using Robot = vamp::robots::Panda;
constexpr std::size_t rake = vamp::FloatVectorWidth;
using Scene = vamp::collision::Environment<float>;
using WideScene = vamp::collision::Environment<vamp::FloatVector<rake>>;

inline std::vector<float> numbers(std::istringstream& words) {
  std::vector<float> all;
  for (float x; words >> x;) all.push_back(x);
  return all;
}

inline Robot::Configuration configuration(const std::vector<float>& q) {
  if (q.size() != Robot::dimension) throw std::runtime_error("a state has seven numbers");
  Robot::ConfigurationArray array;
  std::copy(q.begin(), q.end(), array.begin());
  return Robot::Configuration(array);
}

// Sorted into the same lists as by VAMP's Python bindings. `x` holds centre, Euler angles, then the sizes.
inline void add(Scene& scene, const std::string& kind, const std::vector<float>& x) {
  namespace make = vamp::collision::factory;
  if (kind == "sphere") {
    scene.spheres.push_back(make::sphere::flat(x.at(0), x.at(1), x.at(2), x.at(3)));
  } else if (kind == "capsule") {
    const auto solid = make::cylinder::center::flat(x.at(0), x.at(1), x.at(2), x.at(3), x.at(4), x.at(5), x.at(6), x.at(7));
    (solid.xv == 0 && solid.yv == 0 ? scene.z_aligned_capsules : scene.capsules).push_back(solid);
  } else if (kind == "cuboid") {
    const auto solid = make::cuboid::flat(x.at(0), x.at(1), x.at(2), x.at(3), x.at(4), x.at(5), x.at(6), x.at(7), x.at(8));
    (solid.axis_3_z == 1.F ? scene.z_aligned_cuboids : scene.cuboids).push_back(solid);
  } else {
    throw std::runtime_error("no solid is called " + kind);
  }
}
