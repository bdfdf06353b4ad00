#include <zwang/experiments/god_hand/motion/grips.h>

#include <limits>
#include <stdexcept>

#include <zwang/experiments/god_hand/motion/keyframes.h>
#include <zwang/experiments/god_hand/motion/retarget.h>

namespace zwang::god {
namespace {

using Palm = Pose<double>;

constexpr int thumb_tip = 3, index_tip = 6;  // last phalanxes, of hand::Poses
constexpr double room = 0.012;               // m, between an open finger and the face
constexpr double squeeze = 0.03;             // m: by so much the targets of both fingers together are inside

// The object between the pads, in axes of its own: x from thumb to index finger, z up.
struct Grip {
  Site site;
  Pose<double> between;  // the middle of the pads
  double width;          // m

  explicit Grip(const Site& s) : site(s.about) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t o = 0; o < s.about.objects.size(); ++o) {
      const double far = (s.about.objects[o].pose.position - s.focus).norm();
      if (s.about.objects[o].loose() && far < nearest) nearest = far, site.object = o;
    }
    if (nearest == std::numeric_limits<double>::infinity())
      throw std::invalid_argument("nothing loose in '" + s.about.name + "' to be held");
    const Vec3 up = Vec3::UnitZ();
    const auto wide = [&](const Vec3& axis) { return site.extent(axis)[1] - site.extent(axis)[0]; };
    const Vec3 x = wide(Vec3::UnitX()) <= wide(Vec3::UnitY()) ? Vec3::UnitX() : Vec3::UnitY();
    width = wide(x);
    between.rotation << x, up.cross(x), up;
    between.position = site.middle();
    const double low = site.extent(up)[0], high = site.extent(up)[1];
    between.position.z() = std::min(std::max((low + high) / 2 + 0.01, low + 0.034), high - 0.005);
  }

  // The pads on planes that are so far apart [m].
  Target at(double apart, const Vec3& by = Vec3::Zero()) const {
    Target near;
    const Vec<double, 6> palm{0.0169, -0.0324, 0.0983, -0.483, -0.146, -1.028};  // bones upright beside a box of 70 mm
    near.palm = retract(Pose<double>{}, palm);
    near.angles = {0, 0.845, 0.4, 0, 1.253, 0.25, 0, 0};
    const Pad pads[] = {{index_tip, apart / 2 * Vec3::UnitX(), -Vec3::UnitX()},
                        {thumb_tip, -apart / 2 * Vec3::UnitX(), Vec3::UnitX()}};
    Target found = with_pads(hand::standard(), near, pads);
    found.palm = {between * found.palm.position + by, between.rotation * found.palm.rotation};
    return found;
  }
};

Keyframes closed_about(const Grip& grip) {
  const Target open = grip.at(grip.width + 2 * room), closed = grip.at(grip.width - squeeze);
  const auto over = [&](double height) {
    return Palm{open.palm.position + height * Vec3::UnitZ(), open.palm.rotation};
  };
  Keyframes keys(hand::standard(), over(grip.site.clear_height(0.1, over, open.angles)), open.angles);
  keys.stay(0.1).to(0.8, open.palm).stay(0.9).to(1.3, closed.palm, closed.angles).stay(1.7);
  return keys;
}

}  // namespace

std::vector<Track> lift(const Site& site) {
  const Grip grip(site);
  Vec3 way = site.focus - grip.between.position;
  way.z() = 0;
  way = way.norm() > 0.02 ? Vec3(0.3 * way.normalized()) : Vec3(0.3 * Vec3::UnitY());
  const Vec3 up = 0.2 * Vec3::UnitZ();
  const Target open = grip.at(grip.width + 2 * room), closed = grip.at(grip.width - squeeze);
  const auto moved = [](const Target& t, const Vec3& by) { return Palm{t.palm.position + by, t.palm.rotation}; };
  Keyframes keys = closed_about(grip);
  keys.to(2.7, moved(closed, up)).stay(3).to(4.2, moved(closed, up + way)).stay(5).to(6, moved(closed, way)).stay(6.3);
  keys.to(6.7, moved(open, way), open.angles).stay(6.8).to(7.5, moved(open, way + 0.1 * Vec3::UnitZ()));
  return {keys.track()};
}

std::vector<Track> hold(const Site& site) {
  const Grip grip(site);
  Target closed = grip.at(grip.width - squeeze, 0.1 * Vec3::UnitZ());
  Keyframes keys = closed_about(grip);
  keys.to(2.5, closed.palm).stay(63);
  return {keys.track()};
}

}  // namespace zwang::god
