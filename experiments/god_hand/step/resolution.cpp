#include <zwang/experiments/god_hand/step/resolution.h>

#include <algorithm>
#include <stdexcept>

namespace zwang::god {
namespace {

using collision::Shape;
using collision::Touch;

constexpr double clearance = 5e-5;  // m: objects that are moved end at this gap
constexpr double accepted = 2e-5;   // m: nearer than this an object is moved, or does not stay
constexpr double slack = 5e-4;      // m: how deep objects may lie in each other, as the engine leaves them
constexpr int most_rounds = 40;     // contacts that are projected
constexpr int most_loose = 62;
constexpr double resting = 1e-9;  // m/s
constexpr std::uint64_t god_bit = std::uint64_t{1} << 63, fixed_bit = std::uint64_t{1} << 62;

}  // namespace

Resolution::Resolution(const Surroundings& surroundings, std::span<const Shape> gods)
    : objects_(surroundings.objects), gods_(gods.begin(), gods.end()), fast_(1) {
  for (const Shape& god : gods) {
    for (collision::World* world : {&hands_, &all_}) world->add(god, {}, {god_bit, ~god_bit}, true);
    fast_ = std::min(fast_, god.radius() / 2);
  }
  owner_.resize(gods.size(), nullptr);
  loose_.reserve(objects_.size());  // owner_ points into it
  for (std::size_t k = 0; k < objects_.size(); ++k) {
    const Object& object = objects_[k];
    if (!object.loose()) continue;
    if (loose_.size() == most_loose)
      throw std::invalid_argument("more than " + std::to_string(most_loose) + " loose objects");
    const std::uint64_t bit = std::uint64_t{1} << loose_.size();
    Loose& loose = loose_.emplace_back(Loose{k, all_.size(), 0, 0, object.mass, object.inertia.diagonal()});
    for (const Object::Piece& piece : object.pieces) {
      hands_.add(piece.shape, {}, {bit, god_bit});
      all_.add(piece.shape, {}, {bit, ~bit});
      loose.arm = std::max(loose.arm, piece.at.position.norm() + reach_of(piece.shape));
    }
    loose.end = all_.size();
    owner_.resize(static_cast<std::size_t>(all_.size()), &loose);
  }
  for (const Object& object : objects_) {  // as the engine sees them
    if (object.loose()) continue;
    if (object.pieces.empty()) all_.add(object.mesh, object.pose, {fixed_bit, ~(god_bit | fixed_bit)});
    for (const Object::Piece& piece : object.pieces)
      all_.add(piece.shape, placed(object.pose, piece.at), {fixed_bit, ~(god_bit | fixed_bit)}, true);
  }
  owner_.resize(static_cast<std::size_t>(all_.size()), nullptr);
}

void Resolution::place(collision::World& world, const Loose& loose) const {
  for (int c = loose.first; c < loose.end; ++c)
    world.place(c, placed(loose.pose, objects_[loose.object].pieces[static_cast<std::size_t>(c - loose.first)].at));
}

void Resolution::read(const Physics& physics, PoseSpan before, PoseSpan gods) {
  god_pose_.assign(gods.begin(), gods.end());
  for (Loose& loose : loose_) {
    loose.pose = physics.pose(loose.object);
    loose.before = before[loose.object];
    loose.velocity = physics.velocity(loose.object);
    loose.near = loose.met = loose.swept = loose.moved = loose.returned = false;
    const double reach = loose.arm + (loose.pose.position - loose.before.position).norm() + 1e-3;
    for (std::size_t g = 0; g < gods.size(); ++g)
      loose.near = loose.near || (gods[g].position - loose.pose.position).norm() < reach + reach_of(gods_[g]);
  }
}

// Overlap is seen, with the way out of it, as long as it is less deep than the radii of the two. What moves half of a
// god object's radius or more in one step is therefore stopped where it meets one.
bool Resolution::sweep(Loose& loose) {
  const Vec<double, 6> twist = twist_between(loose.before, loose.pose);
  if (twist.head<3>().norm() + twist.tail<3>().norm() * loose.arm < fast_) return false;
  const Pose<double> goal = loose.pose;
  for (std::size_t g = 0; g < gods_.size(); ++g) hands_.place(static_cast<int>(g), god_pose_[g]);
  for (Loose& other : loose_) {
    if (&other == &loose) other.pose = loose.before;
    place(hands_, other);
  }
  paths_.clear();
  moves_.clear();
  for (const Object::Piece& piece : objects_[loose.object].pieces) {
    collision::Path& path = paths_.emplace_back();
    path.pose = [&loose, &piece, &twist](double s) {
      return placed(retract(loose.before, Vec<double, 6>(s * twist)), piece.at);
    };
    path.spin = twist.tail<3>().norm();
    path.speed = twist.head<3>().norm() + path.spin * piece.at.position.norm();
  }
  for (std::size_t k = 0; k < paths_.size(); ++k)
    moves_.push_back({loose.first + static_cast<int>(k), Vec<double, 6>::Zero(), &paths_[k]});
  const double time = hands_.time_of_contact(moves_).time;
  loose.pose = time < 1 ? retract(loose.before, Vec<double, 6>(time * twist)) : goal;
  return time < 1;
}

// By how much the two are to be moved apart; 0: they may stay.
double Resolution::lacking(const Touch& touch) const {
  const Loose *a = loose_of(touch.a), *b = loose_of(touch.b);
  if (is_god(touch.a) || is_god(touch.b)) return touch.gap < accepted ? clearance - touch.gap : 0;
  const double allowed = std::max(a ? a->allowed : 0, b ? b->allowed : 0);
  return -touch.gap > allowed ? slack / 2 - touch.gap - allowed : 0;
}

// Non-linear projection (Millington, Game Physics Engine Development, 14.3): the penetration is undone by moving and
// turning both bodies in the proportions in which an impulse at the contact would; no turn of more than 0.2 rad, the
// rest of it is moved straight. God objects and fixed ones are infinitely heavy.
void Resolution::project(const Touch& touch, double amount) {
  double ease = 0;
  const auto levered = [&](int collider, double sign, const Vec3& point) {
    Loose* loose = loose_of(collider);
    Lever l = loose ? lever(*loose, point, sign * touch.normal) : Lever{};
    if (loose) ease += l.ease;
    return l;
  };
  const Lever both[2] = {levered(touch.a, 1, touch.point_a), levered(touch.b, -1, touch.point_b)};
  double sign = 1;
  for (const Lever& l : both) {
    if (l.loose) {
      Vec3 turn = l.spin * (amount / ease);
      double straight = amount / ease / l.loose->mass;
      if (const double angle = turn.norm(); angle > 0.2) {
        straight += turn.dot(l.turn) * (1 - 0.2 / angle);
        turn *= 0.2 / angle;
      }
      const Vec3 way = sign * straight * touch.normal;
      l.loose->pose = retract(l.loose->pose, (Vec<double, 6>() << way, turn).finished());
      l.loose->moved = true;
      place(all_, *l.loose);
    }
    sign = -1;
  }
}

void Resolution::put_back(Loose& loose, Resolved& out) {
  loose.pose = loose.before;
  loose.velocity.setZero();
  loose.moved = loose.returned = true;
  place(all_, loose);
  ++out.returned;
}

Resolved Resolution::resolve(Physics& physics, PoseSpan before, PoseSpan gods) {
  Resolved out;
  read(physics, before, gods);
  if (std::none_of(loose_.begin(), loose_.end(), [](const Loose& l) { return l.near; })) return out;
  for (Loose& loose : loose_)
    if (loose.near && sweep(loose)) loose.swept = loose.moved = loose.met = true, ++out.swept;

  meet(accepted, 0);
  for (const Meeting& m : meetings_) {
    m.loose->met = true;
    out.deepest = std::max(out.deepest, -m.gap);
  }
  for (const Loose& loose : loose_) out.overlapping += loose.met;
  if (std::any_of(loose_.begin(), loose_.end(), [](const Loose& l) { return l.met; })) {
    for (std::size_t g = 0; g < gods_.size(); ++g) all_.place(static_cast<int>(g), god_pose_[g]);
    for (Loose& loose : loose_) {
      loose.allowed = slack;
      place(all_, loose);
    }
    // What the engine has left deeper than that stays as deep: it is the engine's to mend.
    for (const Touch& touch : all_.touches(0))
      if (!is_god(touch.a) && !is_god(touch.b))
        for (const int c : {touch.a, touch.b})
          if (Loose* loose = loose_of(c)) loose->allowed = std::max(loose->allowed, -touch.gap);

    // Far from where the engine had left it an object is not mended but moved.
    const double far = 3 * out.deepest + slack;
    const auto lost = [&](const Loose& loose) {
      return !loose.swept && (loose.pose.position - physics.pose(loose.object).position).norm() > far;
    };
    for (; out.rounds < most_rounds && std::none_of(loose_.begin(), loose_.end(), lost); ++out.rounds) {
      double most = 0;
      Touch worst;
      for (const Touch& touch : all_.touches(clearance))
        if (const double here = lacking(touch); here > most) most = here, worst = touch;
      if (most == 0) break;
      project(worst, most);
    }
    for (Loose& loose : loose_)
      if (lost(loose)) put_back(loose, out);
    // What cannot be mended goes back; whatever then lies in its place goes back, too.
    for (bool changed = true; changed;) {
      changed = false;
      for (const Touch& touch : all_.touches(clearance)) {
        if (lacking(touch) == 0) continue;
        for (const int c : {touch.a, touch.b})
          if (Loose* loose = loose_of(c); loose && !loose->returned) {
            put_back(*loose, out);
            changed = true;
          }
        if (changed) break;
      }
    }
  }
  slow(physics);
  return out;
}

// The contacts of loose objects with god objects, and what is taken away of their velocities there.

Resolution::Lever Resolution::lever(Loose& loose, const Vec3& point, const Vec3& normal) const {
  Lever l{&loose, normal, (point - loose.pose.position).cross(normal), {}, 0};
  const Mat3& R = loose.pose.rotation;
  l.spin = R * (R.transpose() * l.turn).cwiseQuotient(loose.inertia);
  l.ease = 1 / loose.mass + l.turn.dot(l.spin);
  return l;
}

// Loose objects nearer than `reach` to god objects, at `ahead` [s] from where they are. As many pairs are looked at as
// lie within each other's spheres.
void Resolution::meet(double reach, double ahead) {
  meetings_.clear();
  for (Loose& loose : loose_) {
    if (!loose.near) continue;
    const Pose<double> pose = retract(loose.pose, Vec<double, 6>(ahead * loose.velocity));
    for (const Object::Piece& piece : objects_[loose.object].pieces) {
      const Pose<double> at = placed(pose, piece.at);
      for (std::size_t g = 0; g < gods_.size(); ++g) {
        const collision::Shape& god = gods_[g];
        const Pose<double>& place = god_pose_[g];
        if ((place.position - at.position).norm() > reach_of(god) + reach_of(piece.shape) + reach) continue;
        const Mat3 inverse = place.rotation.transpose();
        const Pose<double> in_god{inverse * (at.position - place.position), inverse * at.rotation};
        const auto add = [&](const collision::Closest& c) {
          const double gap = c.distance - god.radius() - piece.shape.radius();
          if (gap > reach) return;
          const Vec3 n = place.rotation * c.normal;
          meetings_.push_back({&loose, gap, n, place * c.on_b + (god.radius() + gap) * n});
        };
        const collision::Closest nearest = closest(piece.shape, in_god, {.shape = &god}, 0);
        add(nearest);
        face_contacts(piece.shape, in_god, god, nearest, reach, facing_);
        for (int k = 0; k < facing_.count; ++k) add(facing_.at[static_cast<std::size_t>(k)]);
      }
    }
  }
}

// Takes away what velocity there is toward god objects, contact by contact, each time by the impulse that just does it:
// energy only falls. A box that is stopped at its edge turns into the finger with the next one; so the outcome is tried
// out over a way of `trial`, and what comes near then is a contact as well.
void Resolution::slow(Physics& physics) {
  constexpr double trial = 2e-4;  // m
  levers_.clear();
  double ahead = 0;
  for (int round = 0; round < 10; ++round) {
    meet(round == 0 ? 2 * clearance : clearance, ahead);
    const std::size_t known = levers_.size();
    for (const Meeting& m : meetings_)
      if (const Lever l = lever(*m.loose, m.point, m.normal); approach(l) > resting) levers_.push_back(l);
    if (levers_.size() == known) break;
    for (int pass = 0; pass < 50; ++pass) {
      bool done = true;
      for (const Lever& l : levers_) {
        const double impulse = approach(l) / l.ease;
        if (impulse * l.ease <= resting) continue;
        done = false;
        l.loose->velocity.head<3>() += impulse / l.loose->mass * l.normal;
        l.loose->velocity.tail<3>() += impulse * l.spin;
        l.loose->moved = true;
      }
      if (done) break;
    }
    double fastest = resting;
    for (const Loose& loose : loose_)
      if (loose.near)
        fastest = std::max(fastest, loose.velocity.head<3>().norm() + loose.velocity.tail<3>().norm() * loose.arm);
    ahead = trial / fastest;
  }
  for (const Loose& loose : loose_)
    if (loose.moved) physics.place(loose.object, loose.pose, loose.velocity);
}

}  // namespace zwang::god
