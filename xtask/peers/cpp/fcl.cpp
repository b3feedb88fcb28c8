// FCL's part in `cargo xtask peers`: its headers, compiled here for this processor.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/default_broadphase_callbacks.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/collision_object.h>
#include <fcl/narrowphase/distance.h>
#include <type_traits>
#include "runner.hpp"

using namespace peers;
using Transform = fcl::Transform3<double>;
using Transforms = std::vector<Transform, Eigen::aligned_allocator<Transform>>;

template <class BV>
std::shared_ptr<fcl::BVHModel<BV>> model(const Mesh& mesh) {
  std::vector<fcl::Vector3d> points;
  std::vector<fcl::Triangle> triangles;
  for (const auto& p : mesh.vertices) points.emplace_back(p[0], p[1], p[2]);
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  auto made = std::make_shared<fcl::BVHModel<BV>>();
  made->beginModel(int(triangles.size()), int(points.size()));
  made->addSubModel(points, triangles);
  made->endModel();
  made->computeLocalAABB();
  return made;
}

std::shared_ptr<Transforms> transforms(const Poses& poses) {
  auto all = std::make_shared<Transforms>();
  for (int i = 0; i < poses.records; ++i)
    for (int k = 0; k < poses.bodies; ++k) {
      const double* m = poses.of(i, k);
      Transform t = Transform::Identity();
      t.linear() << m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8];
      t.translation() << m[9], m[10], m[11];
      all->push_back(t);
    }
  return all;
}

fcl::DistanceRequest<double> how_far(bool points) {
  fcl::DistanceRequest<double> request(points);
  request.enable_signed_distance = false;
  return request;
}

const fcl::CollisionRequest<double> YES_OR_NO(1, false);

template <class BV>
void add_pairs(const std::string& lib, const std::string& data, const std::string& extra) {
  constexpr bool measures = std::is_same<BV, fcl::OBBRSS<double>>::value;
  for (std::string tag : {"m4k", "m23k"}) {
    if (!there(data + "/" + tag + ".meta")) continue;
    const auto meta = read_meta(data + "/" + tag + ".meta");
    const auto a = model<BV>(read_mesh(data + "/" + tag + "_A.stl")), b = model<BV>(read_mesh(data + "/" + tag + "_B.stl"));
    for (const auto& set : pair_sets(tag, data, extra)) {
      const auto poses = read_poses(set.file);
      const auto t = transforms(poses);
      const bool path = ends_with(set.name, "_path"), random = ends_with(set.name, "_random");
      if (!path)
        add(lib, set.name, "collide", poses.records, meta, [a, b, t, result = fcl::CollisionResult<double>()](int i) mutable {
          result.clear();
          return double(fcl::collide<double>(a.get(), (*t)[2 * i], b.get(), (*t)[2 * i + 1], YES_OR_NO, result) > 0);
        });
      if constexpr (measures) {
        // `known`: an upper bound of the distance, or the largest number.
        const auto nearest = [a, b, t](int i, double known, const fcl::DistanceRequest<double>& request,
                                       fcl::DistanceResult<double>& result) {
          result.clear();
          result.min_distance = known;
          fcl::distance<double>(a.get(), (*t)[2 * i], b.get(), (*t)[2 * i + 1], request, result);
          return result.min_distance;
        };
        const double unknown = fcl::DistanceResult<double>().min_distance;
        const fcl::DistanceResult<double> none;
        if (!random)
          add(lib, set.name, "distance", poses.records, meta, [=, request = how_far(false), result = none](int i) mutable {
            return nearest(i, unknown, request, result);
          });
        if (!path)
          add(lib + "+ub", set.name, "tolerance", poses.records, meta,
              [=, request = how_far(false), limit = meta.tolerance, result = none](int i) mutable {
                return double(nearest(i, limit, request, result) < limit);
              });
        if (path)
          // The last step's nearest points, carried along by the meshes, bound the distance from above.
          add(lib + "+warm", set.name, "distance", poses.records, meta,
              [=, request = how_far(true), result = none, on_a = fcl::Vector3d(0, 0, 0), on_b = fcl::Vector3d(0, 0, 0)](
                  int i) mutable {
                const auto &pa = (*t)[2 * i], &pb = (*t)[2 * i + 1];
                const bool begins = i % PATH_STEPS == 0;
                const double known = begins ? unknown : (pa * on_a - pb * on_b).norm();
                const double found = nearest(i, begins ? unknown : known * (1 + 1e-14), request, result);
                if (begins || found < known) {
                  on_a = pa.inverse(Eigen::Isometry) * result.nearest_points[0];
                  on_b = pb.inverse(Eigen::Isometry) * result.nearest_points[1];
                }
                return std::min(found, known);
              });
      }
    }
  }
}

// FCL's own manager, one for each arm.
struct Managers {
  std::vector<std::unique_ptr<fcl::CollisionObject<double>>> objects;
  fcl::DynamicAABBTreeCollisionManager<double> a, b;
  template <class Models>
  Managers(const Models& models, const Transforms& t) {
    for (int k = 0; k < 2 * LINKS; ++k) {
      objects.push_back(std::make_unique<fcl::CollisionObject<double>>(models[k % LINKS]));
      (k < LINKS ? a : b).registerObject(objects.back().get());
    }
    place(t, 0);
    a.setup();
    b.setup();
  }
  void place(const Transforms& t, int record) {
    for (int k = 0; k < 2 * LINKS; ++k) {
      objects[k]->setTransform(t[record * 2 * LINKS + k]);
      objects[k]->computeAABB();
    }
    a.update();
    b.update();
  }
};

template <class BV>
void add_arms(const std::string& lib, const std::string& data) {
  if (!there(data + "/robot_link0.stl")) return;
  const auto links = std::make_shared<std::vector<Mesh>>(read_links(data));
  const auto meta = arm_meta(*links);
  std::vector<std::shared_ptr<fcl::BVHModel<BV>>> models;
  for (const auto& link : *links) models.push_back(model<BV>(link));
  for (const auto& set : arm_sets(data)) {
    const auto poses = std::make_shared<Poses>(read_poses(set.file));
    const auto t = transforms(*poses);
    const auto add_arm = [&](const std::string& name, const std::string& query, auto ask) {
      add(name, set.name, query, poses->records, meta, ask);
    };
    add_arm(lib + "+aabb", "collide", [=, result = fcl::CollisionResult<double>()](int i) mutable {
      return double(any_close(*links, *poses, i, 0, [&](int a, int b) {
        result.clear();
        const auto &pa = (*t)[i * 14 + a], &pb = (*t)[i * 14 + LINKS + b];
        return fcl::collide<double>(models[a].get(), pa, models[b].get(), pb, YES_OR_NO, result) > 0;
      }));
    });
    if constexpr (std::is_same<BV, fcl::OBBRSS<double>>::value) {
      // The result is kept from pair to pair: its least distance so far prunes the next.
      const auto nearest = [=, request = how_far(false)](int i, int a, int b, fcl::DistanceResult<double>& result) {
        fcl::distance<double>(models[a].get(), (*t)[i * 14 + a], models[b].get(), (*t)[i * 14 + LINKS + b], request, result);
        return result.min_distance;
      };
      add_arm(lib + "+ub+aabb", "tolerance", [=, result = fcl::DistanceResult<double>()](int i) mutable {
        return double(any_close(*links, *poses, i, ARM_TOLERANCE, [&](int a, int b) {
          result.clear();
          result.min_distance = ARM_TOLERANCE;
          return nearest(i, a, b, result) < ARM_TOLERANCE;
        }));
      });
      add_arm(lib + "+aabb", "distance", [=, result = fcl::DistanceResult<double>()](int i) mutable {
        result.clear();
        return least(*links, *poses, i, [&](int a, int b) { return nearest(i, a, b, result); });
      });
      const auto managers = std::make_shared<Managers>(models, *t);
      add_arm(lib + "+bp", "collide", [=](int i) {
        managers->place(*t, i);
        fcl::DefaultCollisionData<double> found;
        found.request = YES_OR_NO;
        managers->a.collide(&managers->b, &found, fcl::DefaultCollisionFunction<double>);
        return double(found.result.isCollision());
      });
      add_arm(lib + "+bp", "distance", [=](int i) {
        managers->place(*t, i);
        fcl::DefaultDistanceData<double> found;
        found.request = how_far(false);
        managers->a.distance(&managers->b, &found, fcl::DefaultDistanceFunction<double>);
        return found.result.min_distance;
      });
    }
  }
}

int main(int count, char** words) {
  return run(count, words, [](const std::string& data, const std::string& extra) {
    add_pairs<fcl::OBBRSS<double>>("fcl-OBBRSS", data, extra);
    add_pairs<fcl::OBB<double>>("fcl-OBB", data, extra);
    add_arms<fcl::OBBRSS<double>>("fcl-OBBRSS", data);
    add_arms<fcl::OBB<double>>("fcl-OBB", data);
  });
}
