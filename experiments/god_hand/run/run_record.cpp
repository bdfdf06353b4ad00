#include <zwang/experiments/god_hand/run/run_record.h>

#include <algorithm>
#include <array>
#include <bit>
#include <nlohmann/json.hpp>

#include <zwang/bench/results/record_file.h>
#include <zwang/bench/timing/conditions.h>
#include <zwang/core/files/problem_file.h>

namespace zwang::god {
namespace {

using Json = nlohmann::ordered_json;

// One list of the options for writing and for reading: visit(name, option), and with names for those that are words.
template <class Some, class Visit>
void each_option(Some& o, Visit&& visit) {
  visit("dt", o.dt);
  visit("solver", o.solver);
  visit("tolerance", o.tolerance);
  visit("limits", o.limits, std::array{"predictive", "violated"});
  visit("commit", o.commit, std::array{"cycle", "printed"});
  visit("toc_twice", o.toc_twice);
  visit("toc_of_all", o.toc_of_all);
  visit("clusters", o.clusters);
  visit("reduce_contacts", o.reduce_contacts);
  visit("lazy_contacts", o.lazy_contacts);
  visit("maximal", o.maximal);
  visit("force_stiffness", o.force_stiffness);
  visit("force_cap", o.force_cap);
  visit("gap", o.gap);
  visit("activation", o.activation);
  visit("sub_steps", o.sub_steps);
  visit("verify", o.verify);
}

struct Write {
  Json& out;
  void operator()(const char* name, const auto& option) { out[name] = option; }
  void operator()(const char* name, auto choice, const auto& words) {
    out[name] = words[static_cast<std::size_t>(choice)];
  }
};

struct Read {
  const Json& in;
  void operator()(const char* name, auto& option) { in.at(name).get_to(option); }
  void operator()(const char* name, auto& choice, const auto& words) {
    const std::string word = in.at(name);
    const auto at = std::ranges::find(words, word);
    if (at == words.end()) throw std::invalid_argument("no " + std::string(name) + " '" + word + "'");
    choice = static_cast<std::remove_reference_t<decltype(choice)>>(at - words.begin());
  }
};

Json load(const std::filesystem::path& directory) {
  Json j = Json::parse(load_record(directory, "simulated run"));
  if (j.value("kind", "") != "simulation")
    throw BadFile((directory / "run.json").string() + ": not the record of a simulated run");
  return j;
}

// FNV-1a over the bits of numbers.
class Fingerprint {
 public:
  void add(std::uint64_t word) {
    for (int shift = 0; shift < 64; shift += 8) hash_ = (hash_ ^ (word >> shift & 0xff)) * 1099511628211ull;
  }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  void add(const Vec3& v) {
    for (const double number : v) add(number);
  }
  void add(const Pose<double>& pose) {
    add(pose.position);
    for (const double number : pose.rotation.reshaped()) add(number);
  }
  std::uint64_t hash() const { return hash_; }

 private:
  std::uint64_t hash_ = 14695981039346656037ull;
};

std::string hex(std::uint64_t word) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(word));
  return text;
}

}  // namespace

void write_record(const std::filesystem::path& directory, const Record& r) {
  const Conditions c = conditions();
  Json j = {{"zwang", c.version},
            {"kind", "simulation"},
            {"command", r.command},
            {"started", r.started},
            {"finished", r.finished.empty() ? Json(nullptr) : Json(r.finished)}};
  j.update(Json::parse(fixed_conditions()));
  j["debug"] = c.debug;
  j["cores"] = c.cores;
  j["scene"] = r.asked.scene;
  j["parts"] = r.asked.parts;
  j["motion"] = r.asked.motion;
  j["title"] = r.title;
  j["share"] = r.asked.share;
  j["frames"] = r.asked.frames;
  j["audit"] = r.asked.audit;
  each_option(r.asked.options, Write{j["options"]});
  j["hands"] = r.hands;
  j["loose"] = r.loose;
  j["notes"] = r.notes;
  j["recorded"] = r.recorded;
  j["held_over"] = r.held_over;
  j["misfit_mean"] = r.misfit_mean;
  j["misfit_most"] = r.misfit_most;
  j["placement"] = {{"inside", r.placement.inside}, {"depth", r.placement.depth}};
  j["fingerprints"] = {{"motion", hex(r.motion)}, {"surroundings", hex(r.surroundings)}};
  replace_record(directory, j.dump(2));
}

Record read_record(const std::filesystem::path& directory) {
  const Json j = load(directory);
  try {
    Record r;
    r.command = j.at("command");
    r.started = j.at("started");
    if (j.at("finished").is_string()) r.finished = j.at("finished");
    r.asked = {.scene = j.at("scene"),
               .parts = j.at("parts"),
               .motion = j.at("motion"),
               .share = j.at("share"),
               .frames = j.at("frames"),
               .audit = j.at("audit")};
    each_option(r.asked.options, Read{j.at("options")});
    const Options& o = r.asked.options;  // what the command line would not take
    if (!(o.dt >= 1e-5 && o.dt <= 1 && o.tolerance >= 1e-16 && o.tolerance <= 1 && o.force_stiffness >= 0 &&
          o.force_cap >= 0 && o.gap > 0 && o.activation > 0 && o.sub_steps >= 1 && o.sub_steps <= 100 &&
          o.verify >= 0 && r.asked.share >= 0 && r.asked.share <= 1 && r.asked.frames > 0))
      throw std::invalid_argument("an option is out of its range");
    r.title = j.at("title");
    r.hands = j.at("hands");
    r.loose = j.at("loose");
    r.notes = j.at("notes").get<std::vector<std::string>>();
    r.recorded = j.at("recorded");
    r.held_over = j.at("held_over");
    r.misfit_mean = j.at("misfit_mean");
    r.misfit_most = j.at("misfit_most");
    r.placement = {.inside = j.at("placement").at("inside"), .depth = j.at("placement").at("depth")};
    r.motion = std::stoull(j.at("fingerprints").at("motion").get<std::string>(), nullptr, 16);
    r.surroundings = std::stoull(j.at("fingerprints").at("surroundings").get<std::string>(), nullptr, 16);
    return r;
  } catch (const std::exception& broken) {
    throw BadFile((directory / "run.json").string() + ": written by another version of zwang (" + broken.what() + ")");
  }
}

void require_same_program(const std::filesystem::path& directory) {
  require_same_conditions(directory, load(directory).dump(), "its numbers would not be the same");
}

std::uint64_t fingerprint(const HandMotion& motion) {
  Fingerprint f;
  for (const Track& track : motion.hands) {
    f.add(track.model.palm_widths);
    f.add(track.patience);
    for (int body = 1; body < hand::bodies; ++body) f.add(track.model.phalanx(body).length);
    for (const Track::Key& key : track.keys) {
      f.add(key.time);
      f.add(key.target.palm);
      for (const double angle : key.target.angles) f.add(angle);
      f.add(std::uint64_t{key.target.tracked});
    }
  }
  return f.hash();
}

std::uint64_t fingerprint(const Surroundings& surroundings) {
  Fingerprint f;
  f.add(surroundings.gravity);
  for (const Object& object : surroundings.objects) {
    f.add(object.pose);
    f.add(object.mass);
    f.add(object.friction);
    for (const double number : object.inertia.reshaped()) f.add(number);
    if (object.mesh)
      for (const collision::Triangle& triangle : object.mesh->triangles())
        for (const Vec3& corner : triangle.corner) f.add(corner);
    for (const Object::Piece& piece : object.pieces) {
      f.add(piece.at);
      f.add(piece.shape.radius());
      for (const Vec3& corner : piece.shape.corners()) f.add(corner);
    }
  }
  return f.hash();
}

}  // namespace zwang::god
