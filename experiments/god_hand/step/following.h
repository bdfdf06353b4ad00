#pragma once

#include <span>
#include <vector>

#include <zwang/core/model/scene.h>
#include <zwang/experiments/god_hand/step/contacts.h>

namespace zwang::god {

// How far an object that went from `then` to `now` has carried the point of its surface that is at `point` now [m].
inline Vec3 surface_way(const Pose<double>& then, const Pose<double>& now, const Vec3& point) {
  return point - then * Vec3(now.rotation.transpose() * (point - now.position));
}

// To the bit.
inline bool is_same(const Pose<double>& a, const Pose<double>& b) {
  return a.position == b.position && a.rotation == b.rotation;
}

// Where a body would be that had gone with it.
inline Pose<double> moved_with(const Pose<double>& then, const Pose<double>& now, const Pose<double>& body) {
  const Mat3 turn = now.rotation * then.rotation.transpose();
  return {now.position + turn * (body.position - then.position), turn * body.rotation};
}

// Up to where the god objects have gone with each object: by a part of the way that is left to where it is now. The
// objects are the last ones of the scene's bodies.
inline void follow(std::span<Pose<double>> followed, std::span<const Body> bodies, double part) {
  const std::span<const Body> objects = bodies.last(followed.size());
  for (std::size_t o = 0; o < followed.size(); ++o) {
    const Pose<double>& now = objects[o].pose;
    followed[o] = part < 1 ? retract(followed[o], Vec<double, 6>(part * twist_between(followed[o], now))) : now;
  }
}

// May god objects go from poses to others while the objects they hold go from where `objects` has them to `now` (both
// by object)? Two sweeps: among everything but what is held; then, for each object held, relative to it, from where
// they would be had they gone with it. Leaves the god objects in `contacts` anywhere, and what is held at `now`. `step`
// and `along` are storage, one for each god object.
inline bool way_is_clear_with(Contacts& contacts, PoseSpan from, PoseSpan to, std::span<const std::size_t> held,
                              std::span<const Body> objects, PoseSpan now, std::span<Vec<double, 6>> step,
                              std::vector<Pose<double>>& along) {
  const auto clear = [&](PoseSpan start) {
    for (std::size_t b = 0; b < to.size(); ++b) {
      contacts.place(static_cast<BodyId>(b), start[b]);
      step[b] = twist_between(start[b], to[b]);
    }
    return contacts.time_of_contact(step) == 1;
  };
  const Pose<double> away{Vec3::Constant(1e3), Mat3::Identity()};
  for (const std::size_t o : held) contacts.place_object(o, away);
  bool free = clear(from);
  along.resize(to.size());
  for (const std::size_t o : held) {
    contacts.place_object(o, now[o]);
    for (std::size_t b = 0; b < to.size(); ++b) along[b] = moved_with(objects[o].pose, now[o], from[b]);
    free = free && clear(along);
  }
  return free;
}

}  // namespace zwang::god
