#include <algorithm>
#include <cmath>

#include <zwang/bench/scenes/physical.h>
#include <zwang/core/problem/wording.h>
#include <zwang/experiments/god_hand/motion/joint_table.h>

namespace zwang::god {
namespace {

const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();

// The Adroit hand of the DAPG recordings, a right one: in its palm's axes z goes to the fingers, y out of the back, x
// toward the thumb. Measures and axes are those of its public model (vikashplus/Adroit), joint by joint as far as the
// recordings move them; the metacarpal joint of the little finger (LFJ4) stays straight, for our palms are rigid.
struct Limit {
  const char* name;
  double low, high;  // rad
};
constexpr Limit limits[] = {
    {"FFJ3", -0.436, 0.436}, {"FFJ2", 0, 1.571}, {"FFJ1", 0, 1.571},      {"FFJ0", 0, 1.571},
    {"MFJ3", -0.436, 0.436}, {"MFJ2", 0, 1.571}, {"MFJ1", 0, 1.571},      {"MFJ0", 0, 1.571},
    {"RFJ3", -0.436, 0.436}, {"RFJ2", 0, 1.571}, {"RFJ1", 0, 1.571},      {"RFJ0", 0, 1.571},
    {"LFJ3", -0.436, 0.436}, {"LFJ2", 0, 1.571}, {"LFJ1", 0, 1.571},      {"LFJ0", 0, 1.571},
    {"THJ4", -1.047, 1.047}, {"THJ3", 0, 1.309}, {"THJ2", -0.262, 0.262}, {"THJ1", -0.524, 0.524},
    {"THJ0", -1.571, 0},     {"LFJ4", 0, 0.698}, {"WRJ1", -0.524, 0.175}, {"WRJ0", -0.785, 0.611}};
constexpr const char* needed[] = {"ARRx", "ARRy", "ARRz", "palm_x", "palm_y", "palm_z"};
constexpr const char* passed_over =
    "ARTx,ARTy,ARTz,latch,door_hinge,handle_x,handle_y,handle_z,palm_minus_handle_x,palm_minus_handle_y,"
    "palm_minus_handle_z,door_open";
constexpr double step = 0.01;     // s
constexpr double largest = 1000;  // rad, m: no hand is farther away
const Vec3 knuckle[4] = {{0.033, 0, 0.095}, {0.011, 0, 0.099}, {-0.011, 0, 0.095}, {-0.034, 0, 0.088}};
const Vec3 thumb_base(0.034, -0.009, 0.029), palm_middle(0.007, -0.05, 0.07);  // m; palm_x.. is where `palm_middle` is
constexpr double finger_bones[3] = {0.045, 0.025, 0.026}, thumb_bones[3] = {0.038, 0.032, 0.0275};

}  // namespace

Recording adroit_recording(const JointTable& table) {
  std::vector<std::string> wanted = names_of(limits, &Limit::name);
  wanted.insert(wanted.end(), std::begin(needed), std::end(needed));
  std::vector<std::string> known = wanted;
  known.emplace_back("step");
  std::ranges::copy(split(passed_over), std::back_inserter(known));
  table.only(known);
  for (const std::string& name : wanted) table.column(name);
  table.column("step");

  RecordedTrack track;
  std::string farthest;
  std::size_t torn = 0;
  for (const JointTable::Row& row : table.rows) {
    const auto value = [&](const std::string& name) { return row.values[table.column(name)]; };
    const double time = step * value("step");
    if (!std::isfinite(time)) {
      ++torn;
      continue;
    }
    track.frames.push_back({time, std::nullopt});
    const auto sound = [&](const std::string& name) { return std::abs(value(name)) <= largest; };
    if (!std::ranges::all_of(wanted, sound)) continue;
    for (const Limit& limit : limits) {
      const double over = std::max(limit.low - value(limit.name), value(limit.name) - limit.high);
      if (over > track.beyond) track.beyond = over, farthest = limit.name;
    }

    const Mat3 forearm = rotation(-1.57 * x) * rotation(3.14 * z) * rotation(value("ARRx") * x) *
                         rotation(value("ARRy") * y) * rotation(value("ARRz") * z);
    const Mat3 palm = forearm * rotation(value("WRJ1") * y) * rotation(value("WRJ0") * x);
    RecordedHand hand;
    hand.palm.position = {value("palm_x"), value("palm_y"), value("palm_z")};
    hand.palm.rotation << -palm.col(0), palm.col(2), palm.col(1);
    const auto chain = [&](std::size_t finger, const Vec3& base, const std::array<Mat3, 3>& turns,
                           const double* bones) {
      Mat3 axes = palm;
      hand.joints[finger][0] = hand.palm.position + palm * (base - palm_middle);
      for (std::size_t k = 0; k < 3; ++k) {
        axes = axes * turns[k];
        hand.joints[finger][k + 1] = hand.joints[finger][k] + bones[k] * axes.col(2);
      }
    };
    chain(0, thumb_base,
          {Mat3(rotation(2 * std::atan2(0.382499, 0.923956) * y) * rotation(-value("THJ4") * z) *
                rotation(value("THJ3") * x)),
           Mat3(rotation(value("THJ2") * x) * rotation(value("THJ1") * y)), rotation(value("THJ0") * y)},
          thumb_bones);
    for (std::size_t f = 0; f < 4; ++f) {
      const std::string joint = std::string(1, "FMRL"[f]) + "FJ";
      chain(f + 1, knuckle[f],
            {Mat3(rotation(value(joint + "3") * y) * rotation(value(joint + "2") * x)),
             rotation(value(joint + "1") * x), rotation(value(joint + "0") * x)},
            finger_bones);
    }
    track.frames.back().hand = hand;
  }
  Recording out;
  note(out.notes, torn, "without a step");
  note(out.notes, put_in_order(track.frames), "with the step of another");
  const auto whole = std::ranges::count_if(track.frames, [](const auto& f) { return f.hand.has_value(); });
  if (2 * at(whole) < table.rows.size() || whole < 2)
    table.refuse("most rows are not whole: a number in every column expected");
  if (track.frames.back().time - track.frames.front().time > 600)
    table.refuse("more than 10 minutes: steps of 0.01 s expected");
  const double first = track.frames.front().time;
  for (RecordedTrack::Sample& f : track.frames) f.time -= first;
  if (track.beyond > 0)
    out.notes.push_back("angles up to " + std::to_string(track.beyond).substr(0, 5) +
                        " rad beyond the recorded hand's limits (" + farthest + "): held to ours");
  out.hands.push_back(std::move(track));
  return out;
}

}  // namespace zwang::god
