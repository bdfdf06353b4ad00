#include <zwang/experiments/god_hand/run/run_record.h>

#include <algorithm>
#include <bit>
#include <nlohmann/json.hpp>

#include <zwang/bench/results/record_file.h>
#include <zwang/bench/timing/conditions.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/mix_bits.h>
#include <zwang/core/problem/wording.h>
#include <zwang/experiments/god_hand/hand/each_number.h>
#include <zwang/experiments/god_hand/hand/skeleton.h>

namespace zwang::god {
namespace {

using Json = nlohmann::ordered_json;

// Everything in a record but the conditions, once for writing and for reading: visit(place in the JSON, value), and for
// the options as each_option() does.
template <class SomeRecord, class Visit>
void each_entry(SomeRecord& r, const Visit& visit) {
  visit("/command", r.command);
  visit("/started", r.started);
  visit("/finished", r.finished);
  visit("/scene", r.asked.scene);
  visit("/parts", r.asked.parts);
  visit("/god", r.asked.god);
  visit("/motion", r.asked.motion);
  visit("/title", r.title);
  visit("/share", r.asked.share);
  visit("/frames", r.asked.frames);
  visit("/audit", r.asked.audit);
  each_option(r.asked.options, visit);
  visit("/hands", r.hands);
  visit("/bodies", r.bodies);
  visit("/loose", r.loose);
  visit("/notes", r.notes);
  visit("/recorded", r.recorded);
  visit("/held_over", r.held_over);
  visit("/misfit_mean", r.misfit_mean);
  visit("/misfit_most", r.misfit_most);
  visit("/placement/inside", r.placement.inside);
  visit("/placement/depth", r.placement.depth);
  visit.hexadecimal("/fingerprints/motion", r.motion);
  visit.hexadecimal("/fingerprints/surroundings", r.surroundings);
  visit.hexadecimal("/fingerprints/god", r.god);
}

using Place = Json::json_pointer;

struct Write {
  Json& out;
  void operator()(const char* place, const auto& value) const { out[Place(place)] = value; }
  void operator()(const OptionText& text, const auto& option) const { out["options"][text.key] = option; }
  void operator()(const OptionText& text, bool option, const Words&) const { out["options"][text.key] = option; }
  void operator()(const OptionText& text, auto choice, const Words& words) const {
    out["options"][text.key] = words[static_cast<std::size_t>(choice)];
  }
  void hexadecimal(const char* place, std::uint64_t word) const {
    out[Place(place)] = printed("%016llx", static_cast<unsigned long long>(word));
  }
};

struct Read {
  const Json& in;
  void operator()(const char* place, auto& value) const { in.at(Place(place)).get_to(value); }
  template <class T>
  void operator()(const OptionText& text, T& option) const {
    in.at("options").at(text.key).get_to(option);
    if constexpr (std::is_arithmetic_v<T>)
      if (!text.range.holds(static_cast<double>(option)))
        throw std::invalid_argument("options: " + std::string(text.key) + " should be " + text.range.words());
  }
  void operator()(const OptionText& text, bool& option, const Words&) const {
    in.at("options").at(text.key).get_to(option);
  }
  void operator()(const OptionText& text, auto& choice, const Words& words) const {
    const std::string word = in.at("options").at(text.key);
    const auto at = std::ranges::find(words, word);
    if (at == words.end()) throw std::invalid_argument("no " + std::string(text.key) + " '" + word + "'");
    choice = static_cast<std::remove_reference_t<decltype(choice)>>(at - words.begin());
  }
  void hexadecimal(const char* place, std::uint64_t& word) const {
    word = std::stoull(in.at(Place(place)).get<std::string>(), nullptr, 16);
  }
};

Json load(const std::filesystem::path& directory) {
  Json j = load_record(directory, "simulated run");
  if (j.value("kind", "") != "simulation")
    throw BadFile((directory / "run.json").string() + ": not the record of a simulated run");
  return j;
}

// FNV-1a over the bits of numbers.
struct Fingerprint {
  std::uint64_t hash = fnv1a({});

  void add(const auto&... parts) { (each_number(parts, *this), ...); }
  void operator()(double number) { (*this)(std::bit_cast<std::uint64_t>(number)); }
  void operator()(std::integral auto number) {
    const auto word = static_cast<std::uint64_t>(number);
    hash = fnv1a({reinterpret_cast<const char*>(&word), sizeof word}, hash);
  }
};

}  // namespace

void write_record(const std::filesystem::path& directory, const Record& r) {
  const Conditions c = conditions();
  Json j = {{"zwang", c.version}, {"kind", "simulation"}};
  j.update(fixed_conditions());
  j["debug"] = c.debug;
  j["cores"] = c.cores;
  each_entry(r, Write{j});
  if (r.finished.empty()) j["finished"] = nullptr;
  replace_record(directory, j);
}

Record read_record(const std::filesystem::path& directory) {
  Json j = load(directory);
  try {
    if (j.at("finished").is_null()) j["finished"] = "";
    Record r;
    each_entry(r, Read{j});
    if (!(r.asked.share >= 0 && r.asked.share <= 1 && r.asked.frames > 0))
      throw std::invalid_argument("share or frames are out of their ranges");
    return r;
  } catch (const std::exception& broken) {
    throw BadFile((directory / "run.json").string() + ": written by another version of zwang (" + broken.what() + ")");
  }
}

void require_same_program(const std::filesystem::path& directory) {
  require_same_conditions(directory, load(directory), "its numbers would not be the same");
}

std::uint64_t fingerprint(const HandMotion& motion) {
  Fingerprint f;
  for (const Track& track : motion.hands) {
    f.add(track.model.palm_widths, track.patience);
    for (int body = 1; body < hand::bodies; ++body) f.add(track.model.phalanx(body).length);
    for (const auto& [time, target] : track.keys)
      f.add(time, target.palm, target.angles, target.hinges, target.tracked);
  }
  return f.hash;
}

std::uint64_t fingerprint(const Surroundings& surroundings) {
  Fingerprint f;
  f.add(surroundings.gravity);
  for (const Object& object : surroundings.objects) {
    f.add(object.pose, object.mass, object.friction, object.inertia);
    if (object.mesh)
      for (const collision::Triangle& triangle : object.mesh->triangles()) f.add(triangle.corner);
    for (const Object::Piece& piece : object.pieces) f.add(piece.at, piece.shape.radius(), piece.shape.corners());
  }
  return f.hash;
}

// At rest all joints are closed: each anchor of a second body, and where it is.
std::uint64_t fingerprint(const Tool& tool) {
  Fingerprint f;
  GodObjects objects = tool.objects;
  for (std::size_t b = 0; b < objects.shapes.size(); ++b) {
    const Body& body = objects.scene.bodies[b];
    const collision::Shape& shape = objects.shapes[b];
    f.add(body.pose, body.mass, body.inertia, shape.radius(), shape.corners(), objects.filters[b].mask);
  }
  each_joint_list(objects.scene, [&](const auto& list) {
    f.add(list.all.size());
    for (const auto& joint : list.all) {
      f.add(joint.bodies, joint.anchor_b);
      if constexpr (requires { joint.axis_b; }) f.add(joint.axis_b);
    }
  });
  for (const JointLimit& limit : objects.scene.list_of<JointLimit>().all)
    f.add(limit.bodies, limit.bound, limit.side == Side::lower);
  for (const Tool::Drive& drive : tool.drives) f.add(drive.scale, drive.rest, fnv1a(drive.name));
  return f.hash;
}

}  // namespace zwang::god
