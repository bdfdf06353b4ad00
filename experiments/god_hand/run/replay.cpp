#include <zwang/bench/report/page/page.h>
#include <zwang/core/files/embedded.h>
#include <zwang/experiments/god_hand/run/replay.h>

#include <openssl/evp.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include <zwang/bench/timing/conditions.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/experiments/god_hand/hand/hand_shapes.h>
#include <zwang/experiments/god_hand/run/display_mesh.h>
#include <zwang/experiments/god_hand/run/frame_store.h>

// replay.html, bundled like the report's page.
ZWANG_EMBEDDED(replay_html, ZWANG_REPLAY_PAGE)

namespace zwang::god {
namespace {

using Json = nlohmann::ordered_json;
static_assert(std::endian::native == std::endian::little, "the page reads little-endian numbers");

std::string base64(std::string_view bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // a zero ends it
  text.resize(static_cast<std::size_t>(EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                                       reinterpret_cast<const unsigned char*>(bytes.data()),
                                                       static_cast<int>(bytes.size()))));
  return text;
}

template <class Number>
std::string base64(const std::vector<Number>& numbers) {
  return base64(std::string_view(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)));
}

Json to_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

// Position, quaternion x y z w.
Json to_json(const Pose<double>& pose) {
  const Eigen::Quaterniond q(pose.rotation);
  return {pose.position.x(), pose.position.y(), pose.position.z(), q.x(), q.y(), q.z(), q.w()};
}

Json to_json(const collision::Shape& shape) {
  constexpr const char* cores[] = {"point", "segment", "box", "hull"};
  Json corners = Json::array();
  for (const Vec3& corner : shape.corners()) corners.push_back(to_json(corner));
  return {{"core", cores[static_cast<std::size_t>(shape.core())]}, {"radius", shape.radius()}, {"corners", corners}};
}

// What a frame has to say that its neighbours may not: bits, the gravest the highest.
enum Mark : int { untracked = 1, returned = 2, behind = 4, held = 8, stuck = 16, wrong = 32 };
int marks(const Frame& f) {
  return (f.tracked ? 0 : untracked) | (f.returned > 0 ? returned : 0) | (f.behind ? behind : 0) | (f.held ? held : 0) |
         (f.stuck ? stuck : 0) | (fault(f).empty() ? 0 : wrong);
}

// Each mesh once, though several objects be made of it; triangles shared out by the objects' own numbers.
Json scene_json(const Surroundings& surroundings) {
  double all = 0;
  for (const Object& object : surroundings.objects)
    if (object.mesh) all += static_cast<double>(object.mesh->size());
  const double share = all > 0 ? std::min(1.0, static_cast<double>(most_triangles_shown) / all) : 1;
  std::map<const collision::Tree*, std::size_t> known;
  Json meshes = Json::array(), objects = Json::array();
  for (const Object& object : surroundings.objects) {
    Json o = {{"name", object.name}, {"loose", object.loose()}, {"mass", object.mass}, {"pose", to_json(object.pose)}};
    if (object.mesh) {
      const auto [at, fresh] = known.try_emplace(object.mesh.get(), meshes.size());
      if (fresh) {
        const auto triangles = static_cast<double>(object.mesh->size());
        const DisplayMesh m = display_mesh(*object.mesh, static_cast<std::size_t>(std::max(share * triangles, 12.0)));
        meshes.push_back({{"vertices", m.vertices},
                          {"indices", m.indices},
                          {"full", m.full},
                          {"error", m.error},
                          {"low", to_json(m.low)},
                          {"size", m.size},
                          {"vertex_bytes", base64(m.vertex_bytes)},
                          {"index_bytes", base64(m.index_bytes)}});
      }
      o["mesh"] = at->second;
    } else {
      o["pieces"] = Json::array();
      for (const Object::Piece& piece : object.pieces) {
        Json p = to_json(piece.shape);
        p["at"] = to_json(piece.at);
        o["pieces"].push_back(p);
      }
    }
    objects.push_back(o);
  }
  return {{"meshes", meshes}, {"objects", objects}, {"focus", to_json(surroundings.focus)}};
}

// 14 bytes a pose: all positions as 3 x u16 over their box, then all quaternions as 4 x i16; frame after frame target,
// god objects, loose objects.
Json poses_json(const std::vector<Frame>& frames) {
  Vec3 low = Vec3::Constant(1e300), high = -low;
  const auto each = [&frames](const auto& visit) {
    for (const Frame& frame : frames)
      for (const auto* poses : {&frame.target, &frame.god, &frame.loose})
        for (const Pose<double>& pose : *poses) visit(pose);
  };
  each([&](const Pose<double>& pose) {
    if (!pose.position.allFinite()) return;
    low = low.cwiseMin(pose.position);
    high = high.cwiseMax(pose.position);
  });
  const double size = std::max((high - low).maxCoeff(), 1e-9);
  std::vector<std::uint16_t> positions;
  std::vector<std::int16_t> quaternions;
  each([&](const Pose<double>& pose) {
    const Eigen::Quaterniond q(pose.rotation);
    for (int k = 0; k < 3; ++k) {
      const double steps = 65535 * (pose.position[k] - low[k]) / size;
      positions.push_back(static_cast<std::uint16_t>(steps >= 0 ? std::lround(std::min(steps, 65535.0)) : 0));
    }
    for (const double part : {q.x(), q.y(), q.z(), q.w()})
      quaternions.push_back(static_cast<std::int16_t>(std::isfinite(part) ? std::lround(32767 * part) : 0));
  });
  return {
      {"low", to_json(low)}, {"size", size}, {"positions", base64(positions)}, {"quaternions", base64(quaternions)}};
}

// Column by column in single precision.
Json numbers_json(const std::vector<Frame>& frames) {
  Json out;
  const auto add = [&](const std::string& key, const auto& of) {
    out[key] = base64(mapped(frames, [&](const Frame& frame) { return static_cast<float>(of(frame)); }));
  };
  for (const Column& column : columns()) add(column.key, [&](const Frame& f) { return column.of(f); });
  for (std::size_t k = 0; k < stage_names.size(); ++k)
    add(stage_names[k], [k](const Frame& f) { return stages(f.times)[k]; });
  add("force", [](const Frame& f) { return f.palm_wrench.head<3>().norm(); });
  add("torque", [](const Frame& f) { return f.palm_wrench.tail<3>().norm(); });
  add("marks", [](const Frame& f) { return marks(f); });
  add("number", [](const Frame& f) { return static_cast<double>(f.number); });
  return out;
}

// 8 numbers a contact in single precision: point, normal, gap, push; and body, object as i16.
Json contacts_json(const std::vector<Frame>& frames) {
  std::vector<std::uint32_t> start = {0};
  std::vector<float> numbers;
  std::vector<std::int16_t> who;
  for (const Frame& frame : frames) {
    for (const FrameContact& c : frame.contacts) {
      for (const double x :
           {c.point.x(), c.point.y(), c.point.z(), c.normal.x(), c.normal.y(), c.normal.z(), c.gap, c.push})
        numbers.push_back(static_cast<float>(x));
      who.push_back(static_cast<std::int16_t>(c.body));
      who.push_back(static_cast<std::int16_t>(c.object));
    }
    start.push_back(static_cast<std::uint32_t>(who.size() / 2));
  }
  return {{"start", base64(start)}, {"numbers", base64(numbers)}, {"who", base64(who)}};
}

// Words that occur in few frames' lines: as indices into the list of those that do occur.
template <class Name>
Json words_json(const std::vector<Frame>& frames, const Name& name) {
  std::vector<std::string> words;
  std::vector<std::uint16_t> index;
  for (const Frame& frame : frames) {
    const std::string word(name(frame));
    const auto at = std::find(words.begin(), words.end(), word);
    index.push_back(static_cast<std::uint16_t>(at - words.begin()));
    if (at == words.end()) words.push_back(word);
  }
  return {{"words", words}, {"index", base64(index)}};
}

}  // namespace

void ShownFrames::add(const Frame& frame) {
  const long places = std::min(total_, most_frames_shown), here = std::min(added_++ * places / total_, places - 1);
  if (here != place_)
    frames_.push_back(frame);
  else if (marks(frame) > marks(frames_.back()))
    frames_.back() = frame;
  place_ = here;
}

std::filesystem::path write_replay(const std::filesystem::path& directory, const Record& record, const Summary& summary,
                                   const std::vector<Frame>& frames, const Surroundings& surroundings,
                                   std::span<const ShownGod> gods) {
  if (frames.empty()) throw BadFile(directory.string() + ": no frame to show");
  const Conditions c = conditions();
  Json hands = Json::array(), bodies = Json::array();
  for (const ShownGod& god : gods) {
    Json shapes = Json::array();
    for (const collision::Shape& shape : god.shapes) shapes.push_back(to_json(shape));
    hands.push_back({{"name", god.name}, {"left", god.left}, {"shapes", shapes}});
  }
  const bool tool = gods.size() == 1 && gods[0].name != "hand";
  for (int body = 0; body < (tool ? static_cast<int>(gods[0].shapes.size()) : hand::bodies); ++body)
    bodies.push_back(tool ? gods[0].name + " " + std::to_string(body + 1) : hand::body_name(body));
  const Json data = {
      {"scene", record.asked.scene},
      {"motion", record.title},
      {"solver", record.asked.options.solver},
      {"dt", record.asked.options.dt},
      {"command", record.command},
      {"conditions", "commit " + c.commit.substr(0, 12) + ", " + c.compiler + ", " + c.cpu},
      {"started", record.started},
      {"finished", record.finished},
      {"lines", summary.lines(record)},
      {"total", summary.frames()},
      {"frames", frames.size()},
      {"stages", stage_names},
      {"hands", hands},
      {"bodies", bodies},
      {"surroundings", scene_json(surroundings)},
      {"poses", poses_json(frames)},
      {"numbers", numbers_json(frames)},
      {"contacts", contacts_json(frames)},
      {"claimed", words_json(frames, [](const Frame& f) { return to_string(f.claimed); })},
      {"verified",
       words_json(frames, [](const Frame& f) { return f.verified ? to_string(*f.verified) : "not looked at"; })},
      {"fault", words_json(frames, fault)}};
  const std::filesystem::path file = directory / "replay.html";
  replace_file(file, report::filled(replay_html(), data.dump(-1, ' ', false, Json::error_handler_t::replace)));
  return file;
}

}  // namespace zwang::god
