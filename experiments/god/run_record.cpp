#include "experiments/god/run_record.h"

#include <bit>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/suite/conditions.h"
#include "core/problem_file.h"

namespace zwang::god {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Options& o) {
  return {{"dt", o.dt},
          {"solver", o.solver},
          {"tolerance", o.tolerance},
          {"limits", o.limits == Options::Limits::predictive ? "predictive" : "violated"},
          {"commit", o.commit == Options::Commit::cycle ? "cycle" : "printed"},
          {"toc_twice", o.toc_twice},
          {"toc_of_all", o.toc_of_all},
          {"clusters", o.clusters},
          {"reduce_contacts", o.reduce_contacts},
          {"lazy_contacts", o.lazy_contacts},
          {"maximal", o.maximal},
          {"force_stiffness", o.force_stiffness},
          {"force_cap", o.force_cap},
          {"gap", o.gap},
          {"activation", o.activation},
          {"sub_steps", o.sub_steps},
          {"verify", o.verify}};
}

Options options_from(const Json& j) {
  Options o;
  o.dt = j.at("dt");
  o.solver = j.at("solver");
  o.tolerance = j.at("tolerance");
  o.limits = j.at("limits") == "predictive" ? Options::Limits::predictive : Options::Limits::violated;
  o.commit = j.at("commit") == "cycle" ? Options::Commit::cycle : Options::Commit::printed;
  o.toc_twice = j.at("toc_twice");
  o.toc_of_all = j.at("toc_of_all");
  o.clusters = j.at("clusters");
  o.reduce_contacts = j.at("reduce_contacts");
  o.lazy_contacts = j.at("lazy_contacts");
  o.maximal = j.at("maximal");
  o.force_stiffness = j.at("force_stiffness");
  o.force_cap = j.at("force_cap");
  o.gap = j.at("gap");
  o.activation = j.at("activation");
  o.sub_steps = j.at("sub_steps");
  o.verify = j.at("verify");
  return o;
}

// What decides the bits of a result.
Json program() {
  const Conditions c = conditions();
  return {{"commit", c.commit},         {"compiler", c.compiler}, {"flags", c.flags},
          {"build_type", c.build_type}, {"cpu", c.cpu},           {"libraries", c.libraries}};
}

Json load(const std::filesystem::path& directory) {
  const auto file = directory / "run.json";
  std::ifstream in(file);
  if (!in) throw BadFile(directory.string() + " holds no simulated run: run.json is missing");
  try {
    Json j = Json::parse(in);
    if (j.value("kind", "") != "simulation") throw BadFile(file.string() + ": not the record of a simulated run");
    return j;
  } catch (const Json::exception&) {
    throw BadFile(file.string() + ": not a JSON object");
  }
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
  std::uint64_t hash_ = 1469598103934665603ull;
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
  j.update(program());
  j["dirty"] = c.dirty;
  j["debug"] = c.debug;
  j["cores"] = c.cores;
  j["scene"] = r.asked.scene;
  j["parts"] = r.asked.parts;
  j["motion"] = r.asked.motion;
  j["title"] = r.title;
  j["share"] = r.asked.share;
  j["frames"] = r.asked.frames;
  j["audit"] = r.asked.audit;
  j["options"] = to_json(r.asked.options);
  j["hands"] = r.hands;
  j["loose"] = r.loose;
  j["notes"] = r.notes;
  j["recorded"] = r.recorded;
  j["held_over"] = r.held_over;
  j["misfit_mean"] = r.misfit_mean;
  j["misfit_most"] = r.misfit_most;
  j["placement"] = {{"inside", r.placement.inside}, {"depth", r.placement.depth}};
  j["fingerprints"] = {{"motion", hex(r.motion)}, {"surroundings", hex(r.surroundings)}};

  const auto file = directory / "run.json", draft = directory / "run.json.new";
  std::ofstream out(draft);
  out << j.dump(2) << '\n';
  out.close();
  if (!out) throw BadFile("cannot write " + file.string());
  std::filesystem::rename(draft, file);
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
               .options = options_from(j.at("options")),
               .share = j.at("share"),
               .frames = j.at("frames"),
               .audit = j.at("audit")};
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

bool holds_run(const std::filesystem::path& directory) {
  return std::filesystem::exists(directory / "run.json") || std::filesystem::exists(directory / "frames.jsonl") ||
         std::filesystem::exists(directory / "results.jsonl");
}

void require_same_program(const std::filesystem::path& directory) {
  const Json stored = load(directory), here = program();
  for (const auto& [name, value] : here.items())
    if (const Json was = stored.value(name, Json()); was != value)
      throw std::invalid_argument(directory.string() + " cannot go on, its numbers would not be the same: its " + name +
                                  " is " + was.dump() + ", now it is " + value.dump());
}

std::uint64_t fingerprint(const Motion& motion) {
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
