// Coal's part in `cargo xtask peers`: its meshes with OBBRSS and OBB trees, asked in every way that is quick.
#include <coal/BVH/BVH_model.h>
#include <coal/broadphase/broadphase_dynamic_AABB_tree.h>
#include <coal/broadphase/default_broadphase_callbacks.h>
#include <coal/collision.h>
#include <coal/collision_object.h>
#include <coal/distance.h>
#include <type_traits>
#include "runner.hpp"

using namespace peers;
using Transforms = std::vector<coal::Transform3s, Eigen::aligned_allocator<coal::Transform3s>>;

template <class BV>
std::shared_ptr<coal::BVHModel<BV>> model(const Mesh& mesh) {
  std::vector<coal::Vec3s> points;
  std::vector<coal::Triangle> triangles;
  for (const auto& p : mesh.vertices) points.emplace_back(p[0], p[1], p[2]);
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  auto made = std::make_shared<coal::BVHModel<BV>>();
  made->beginModel(unsigned(triangles.size()), unsigned(points.size()));
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
      coal::Matrix3s rotation;
      rotation << m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8];
      all->emplace_back(rotation, coal::Vec3s(m[9], m[10], m[11]));
    }
  return all;
}

coal::CollisionRequest yes_or_no(double margin) {
  coal::CollisionRequest request(coal::NO_REQUEST, 1);
  request.security_margin = margin;
  return request;
}

coal::DistanceRequest how_far() {
  coal::DistanceRequest request;
  request.enable_signed_distance = false;
  return request;
}

template <class BV>
void add_pairs(const std::string& lib, const std::string& data, const std::string& extra) {
  constexpr bool measures = std::is_same<BV, coal::OBBRSS>::value;
  for (std::string tag : {"m4k", "m23k"}) {
    if (!there(data + "/" + tag + ".meta")) continue;
    const auto meta = read_meta(data + "/" + tag + ".meta");
    const auto a = model<BV>(read_mesh(data + "/" + tag + "_A.stl")), b = model<BV>(read_mesh(data + "/" + tag + "_B.stl"));
    for (const auto& set : pair_sets(tag, data, extra)) {
      const auto poses = read_poses(set.file);
      const auto t = transforms(poses);
      const bool path = ends_with(set.name, "_path"), random = ends_with(set.name, "_random");
      auto touches = [a, b, t, ask = coal::ComputeCollision(a.get(), b.get()), result = coal::CollisionResult()](
                               int i, const coal::CollisionRequest& request) mutable {
        result.clear();
        return double(ask((*t)[2 * i], (*t)[2 * i + 1], request, result) > 0);
      };
      if (!path) {
        add(lib, set.name, "collide", poses.records, meta,
            [touches, request = yes_or_no(0)](int i) mutable { return touches(i, request); });
        add(lib, set.name, "tolerance", poses.records, meta,
            [touches, request = yes_or_no(meta.tolerance)](int i) mutable { return touches(i, request); });
      }
      if constexpr (measures) {
        // `known`: an upper bound of the distance, or the largest number.
        auto nearest = [a, b, t, ask = coal::ComputeDistance(a.get(), b.get()), request = how_far()](
                                 int i, double known, coal::DistanceResult& result) mutable {
          result.clear();
          result.min_distance = known;
          ask((*t)[2 * i], (*t)[2 * i + 1], request, result);
          return result.min_distance;
        };
        const double unknown = coal::DistanceResult().min_distance;
        add(lib, set.name, "distance", poses.records, meta,
            [nearest, unknown, result = coal::DistanceResult()](int i) mutable { return nearest(i, unknown, result); });
        if (!path && !random)
          add(lib + "+ub", set.name, "tolerance", poses.records, meta,
              [nearest, limit = meta.tolerance, result = coal::DistanceResult()](int i) mutable {
                return double(nearest(i, limit, result) < limit);
              });
        if (path)
          // The last step's nearest points, carried along by the meshes, bound the distance from above.
          add(lib + "+warm", set.name, "distance", poses.records, meta,
              [nearest, unknown, t, result = coal::DistanceResult(), on_a = coal::Vec3s(0, 0, 0), on_b = coal::Vec3s(0, 0, 0)](
                  int i) mutable {
                const auto &pa = (*t)[2 * i], &pb = (*t)[2 * i + 1];
                const double known = i % PATH_STEPS == 0 ? unknown : (pa.transform(on_a) - pb.transform(on_b)).norm();
                const double found = nearest(i, known == unknown ? unknown : known * (1 + 1e-14), result);
                if (known == unknown || found < known) {
                  on_a = pa.inverseTimes(coal::Transform3s(result.nearest_points[0])).getTranslation();
                  on_b = pb.inverseTimes(coal::Transform3s(result.nearest_points[1])).getTranslation();
                }
                return std::min(found, known);
              });
      }
    }
  }
}

// Coal's own manager, one for each arm.
struct Managers {
  std::vector<std::unique_ptr<coal::CollisionObject>> objects;
  coal::DynamicAABBTreeCollisionManager a, b;
  template <class Models>
  Managers(const Models& models, const Transforms& t) {
    for (int k = 0; k < 2 * LINKS; ++k) {
      objects.push_back(std::make_unique<coal::CollisionObject>(models[k % LINKS], false));
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

// One question per pair of links. It points to the models, so it keeps them.
template <class Models, class Ask>
struct Questions {
  Models models;
  std::vector<Ask> pairs;
  explicit Questions(const Models& all) : models(all) {
    for (int k = 0; k < LINKS * LINKS; ++k) pairs.emplace_back(models[k / LINKS].get(), models[k % LINKS].get());
  }
};

template <class BV>
void add_arms(const std::string& lib, const std::string& data) {
  if (!there(data + "/robot_link0.stl")) return;
  const auto links = std::make_shared<std::vector<Mesh>>(read_links(data));
  const auto meta = arm_meta(*links);
  std::vector<std::shared_ptr<coal::BVHModel<BV>>> models;
  for (const auto& link : *links) models.push_back(model<BV>(link));
  const auto asks = std::make_shared<Questions<decltype(models), coal::ComputeCollision>>(models);
  for (const auto& set : arm_sets(data)) {
    const auto poses = std::make_shared<Poses>(read_poses(set.file));
    const auto t = transforms(*poses);
    const auto add_arm = [&](const std::string& name, const std::string& query, auto ask) {
      add(name, set.name, query, poses->records, meta, ask);
    };
    const auto touches = [=](double margin) {
      return [=, request = yes_or_no(margin), result = coal::CollisionResult()](int i) mutable {
        return double(any_close(*links, *poses, i, margin, [&](int a, int b) {
          result.clear();
          return asks->pairs[a * LINKS + b]((*t)[i * 14 + a], (*t)[i * 14 + LINKS + b], request, result) > 0;
        }));
      };
    };
    add_arm(lib + "+aabb", "collide", touches(0));
    add_arm(lib + "+aabb", "tolerance", touches(ARM_TOLERANCE));
    if constexpr (std::is_same<BV, coal::OBBRSS>::value) {
      const auto measures = std::make_shared<Questions<decltype(models), coal::ComputeDistance>>(models);
      // The result is kept from pair to pair: its least distance so far prunes the next.
      const auto nearest = [=, request = how_far()](int i, int a, int b, coal::DistanceResult& result) {
        measures->pairs[a * LINKS + b]((*t)[i * 14 + a], (*t)[i * 14 + LINKS + b], request, result);
        return result.min_distance;
      };
      add_arm(lib + "+ub+aabb", "tolerance", [=, result = coal::DistanceResult()](int i) mutable {
        return double(any_close(*links, *poses, i, ARM_TOLERANCE, [&](int a, int b) {
          result.clear();
          result.min_distance = ARM_TOLERANCE;
          return nearest(i, a, b, result) < ARM_TOLERANCE;
        }));
      });
      add_arm(lib + "+aabb", "distance", [=, result = coal::DistanceResult()](int i) mutable {
        result.clear();
        return least(*links, *poses, i, [&](int a, int b) { return nearest(i, a, b, result); });
      });
      const auto managers = std::make_shared<Managers>(models, *t);
      add_arm(lib + "+bp", "collide", [=](int i) {
        managers->place(*t, i);
        coal::CollisionCallBackDefault found;
        found.data.request = yes_or_no(0);
        managers->a.collide(&managers->b, &found);
        return double(found.data.result.isCollision());
      });
      add_arm(lib + "+bp", "distance", [=](int i) {
        managers->place(*t, i);
        coal::DistanceCallBackDefault found;
        found.data.request = how_far();
        managers->a.distance(&managers->b, &found);
        return found.data.result.min_distance;
      });
    }
  }
}

int main(int count, char** words) {
  return run(count, words, [](const std::string& data, const std::string& extra) {
    add_pairs<coal::OBBRSS>("coal-OBBRSS", data, extra);
    add_pairs<coal::OBB>("coal-OBB", data, extra);
    add_arms<coal::OBBRSS>("coal-OBBRSS", data);
    add_arms<coal::OBB>("coal-OBB", data);
  });
}
