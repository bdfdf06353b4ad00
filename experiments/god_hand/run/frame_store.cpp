#include <zwang/experiments/god_hand/run/frame_store.h>

#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include <zwang/core/files/problem_file.h>
#include <zwang/experiments/god_hand/run/summary.h>

namespace zwang::god {
namespace {

constexpr std::array all_columns = {
    Column{"t", &Frame::time},
    Column{"gap", &Frame::gap},
    Column{"depth", &Frame::target_depth},
    Column{"joint", &Frame::separation},
    Column{"limit", &Frame::limit},
    Column{"dist", &Frame::distance},
    Column{"slide", &Frame::lost_slide},
    Column{"jitter", &Frame::jitter},
    Column{"work", &Frame::work},
    Column{"impulse", &Frame::impulse_error},
    Column{"speed", &Frame::object_speed},
    Column{"rows", nullptr, &Frame::rows},
    Column{"raw", nullptr, &Frame::raw},
    Column{"kept", nullptr, &Frame::kept},
    Column{"completed", nullptr, &Frame::completed},
    Column{"sub", nullptr, &Frame::sub_steps},
    Column{"returned", nullptr, &Frame::returned},
    Column{"tracked", nullptr, nullptr, &Frame::tracked},
    Column{"held", nullptr, nullptr, &Frame::held},
    Column{"stuck", nullptr, nullptr, &Frame::stuck},
    Column{"behind", nullptr, nullptr, &Frame::behind},
};

// Shortest text that reads back as the same number; JSON has no NaN.
template <class Number>
void put(std::string& line, Number number) {
  if constexpr (std::is_floating_point_v<Number>)
    if (!std::isfinite(number)) {
      line += "null";
      return;
    }
  char text[32];
  line.append(text, std::to_chars(text, text + sizeof text, number).ptr);
}

void put_key(std::string& line, std::string_view key) { line.append(",\"").append(key).append("\":"); }

template <class Numbers>
void put_all(std::string& line, std::string_view key, const Numbers& numbers) {
  put_key(line, key);
  char before = '[';
  for (const double number : numbers) {
    line += before;
    put(line, number);
    before = ',';
  }
  line += ']';
}

// Points of contacts are drawn, not computed with: single precision.
void put(std::string& line, const FrameContact& c) {
  line += '[';
  put(line, c.body);
  line += ',';
  put(line, c.object);
  for (const double number :
       {c.point.x(), c.point.y(), c.point.z(), c.normal.x(), c.normal.y(), c.normal.z(), c.gap, c.push}) {
    line += ',';
    put(line, static_cast<float>(number));
  }
  line += ']';
}

double number_of(const nlohmann::json& j) { return j.is_null() ? std::nan("") : j.get<double>(); }

// The enumerator of this name.
template <class Enum>
Enum named(const std::string& name, Enum last) {
  for (int i = 0; i <= static_cast<int>(last); ++i)
    if (to_string(static_cast<Enum>(i)) == name) return static_cast<Enum>(i);
  throw BadFile("no status '" + name + "'");
}

Frame frame_from(const nlohmann::json& j) {
  Frame frame;
  frame.number = j.at("n");
  for (const Column& column : all_columns) {
    const nlohmann::json& value = j.at(column.key);
    if (column.number) frame.*column.number = number_of(value);
    if (column.count) frame.*column.count = value;
    if (column.flag) frame.*column.flag = value.get<int>() != 0;
  }
  for (std::size_t k = 0; k < 6; ++k) frame.device[static_cast<Index>(k)] = number_of(j.at("device").at(k));
  const auto seconds = [&j](std::size_t k) { return number_of(j.at("times").at(k)); };
  frame.times = {.physics = seconds(0),
                 .resolution = seconds(1),
                 .assembly = seconds(2),
                 .solve = seconds(3),
                 .search = seconds(4),
                 .other = seconds(5)};
  frame.claimed = named(j.at("claimed"), Status::crashed);
  if (!j.at("verified").is_null()) frame.verified = named(j.at("verified"), Verdict::unsupported);
  for (const nlohmann::json& c : j.at("contacts")) {
    FrameContact& contact = frame.contacts.emplace_back();
    contact.body = c.at(0);
    contact.object = c.at(1);
    for (std::size_t k = 0; k < 3; ++k) {
      contact.point[static_cast<Index>(k)] = number_of(c.at(2 + k));
      contact.normal[static_cast<Index>(k)] = number_of(c.at(5 + k));
    }
    contact.gap = number_of(c.at(8));
    contact.push = number_of(c.at(9));
  }
  return frame;
}

// poses.bin: this, then records of 7 doubles a pose: position, quaternion x y z w.
struct PosesHead {
  std::array<char, 8> magic = {'z', 'w', 'p', 'o', 's', 'e', 's', '1'};
  std::uint32_t bodies = 0, loose = 0;

  std::size_t poses() const { return 2 * std::size_t{bodies} + loose; }
  std::size_t record() const { return poses() * 7 * sizeof(double); }
};

std::array<double, 7> seven(const Pose<double>& pose) {
  const Eigen::Quaterniond q(pose.rotation);
  return {pose.position.x(), pose.position.y(), pose.position.z(), q.x(), q.y(), q.z(), q.w()};
}

Pose<double> pose_of(const double* p) {
  return {{p[0], p[1], p[2]}, Eigen::Quaterniond(p[6], p[3], p[4], p[5]).normalized().toRotationMatrix()};
}

// Where line `keep` of the file ends.
std::uintmax_t end_of_lines(const std::filesystem::path& file, long keep) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  std::uintmax_t end = 0;
  for (long k = 0; k < keep; ++k) {
    if (!std::getline(in, line) || in.eof())
      throw BadFile(file.string() + ": holds " + std::to_string(k) + " whole frames, the checkpoint is after " +
                    std::to_string(keep));
    end += line.size() + 1;
  }
  return end;
}

}  // namespace

std::span<const Column> columns() { return all_columns; }

FrameWriter::FrameWriter(const std::filesystem::path& directory, std::size_t bodies, std::size_t loose, long keep)
    : directory_(directory), bodies_(bodies), loose_(loose) {
  const auto lines = directory / "frames.jsonl", poses = directory / "poses.bin";
  PosesHead head;
  head.bodies = static_cast<std::uint32_t>(bodies);
  head.loose = static_cast<std::uint32_t>(loose);
  if (keep > 0) {
    const std::uintmax_t whole = sizeof head + static_cast<std::uintmax_t>(keep) * head.record();
    if (!std::filesystem::exists(poses) || std::filesystem::file_size(poses) < whole)
      throw BadFile(poses.string() + ": shorter than the checkpoint says");
    std::filesystem::resize_file(lines, end_of_lines(lines, keep));
    std::filesystem::resize_file(poses, whole);
  }
  const auto mode = std::ios::binary | (keep > 0 ? std::ios::app : std::ios::trunc);
  lines_.open(lines, mode);
  poses_.open(poses, mode);
  if (keep == 0) poses_.write(reinterpret_cast<const char*>(&head), sizeof head);
  flush();
}

void FrameWriter::write(const Frame& frame) {
  if (frame.target.size() != bodies_ || frame.god.size() != bodies_ || frame.loose.size() != loose_)
    throw std::logic_error("frame " + std::to_string(frame.number) + " has " + std::to_string(frame.god.size()) +
                           " god objects and " + std::to_string(frame.loose.size()) + " loose ones, the run " +
                           std::to_string(bodies_) + " and " + std::to_string(loose_));
  line_ = "{\"n\":";
  put(line_, frame.number);
  for (const Column& column : all_columns) {
    put_key(line_, column.key);
    put(line_, column.of(frame));
  }
  put_all(line_, "device", frame.device);
  put_key(line_, "claimed");
  line_.append("\"").append(to_string(frame.claimed)).append("\"");
  put_key(line_, "verified");
  if (frame.verified)
    line_.append("\"").append(to_string(*frame.verified)).append("\"");
  else
    line_.append("null");
  put_all(line_, "times", stages(frame.times));
  put_key(line_, "contacts");
  line_ += '[';
  for (const FrameContact& contact : frame.contacts) {
    put(line_, contact);
    line_ += ',';
  }
  if (line_.back() == ',') line_.pop_back();
  line_ += "]}\n";
  for (const auto* poses : {&frame.target, &frame.god, &frame.loose})
    for (const Pose<double>& pose : *poses) {
      const std::array<double, 7> numbers = seven(pose);
      poses_.write(reinterpret_cast<const char*>(numbers.data()), sizeof numbers);
    }
  lines_ << line_;
}

void FrameWriter::flush() {
  if (!lines_.flush() || !poses_.flush()) throw BadFile("cannot write the frames to " + directory_.string());
}

long read_frames(const std::filesystem::path& directory, const std::function<void(const Frame&)>& visit) {
  const auto lines = directory / "frames.jsonl", poses = directory / "poses.bin";
  std::ifstream text(lines, std::ios::binary), binary(poses, std::ios::binary);
  PosesHead head, expected;
  if (!text || !binary.read(reinterpret_cast<char*>(&head), sizeof head) || head.magic != expected.magic)
    throw BadFile(directory.string() + ": no frames of a simulated run (frames.jsonl, poses.bin)");
  std::vector<double> record(head.record() / sizeof(double));
  std::string line;
  long frames = 0;
  while (std::getline(text, line) && !text.eof() &&
         binary.read(reinterpret_cast<char*>(record.data()), static_cast<std::streamsize>(head.record()))) {
    Frame frame;
    try {
      frame = frame_from(nlohmann::json::parse(line));
    } catch (const std::exception& broken) {
      throw BadFile(lines.string() + ":" + std::to_string(frames + 1) + ": not a frame (" + broken.what() + ")");
    }
    const double* at = record.data();
    const auto take = [&at](std::vector<Pose<double>>& list, std::size_t count) {
      for (std::size_t k = 0; k < count; ++k, at += 7) list.push_back(pose_of(at));
    };
    take(frame.target, head.bodies);
    take(frame.god, head.bodies);
    take(frame.loose, head.loose);
    visit(frame);
    ++frames;
  }
  return frames;
}

}  // namespace zwang::god
