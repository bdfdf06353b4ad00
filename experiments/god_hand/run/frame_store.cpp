#include <zwang/experiments/god_hand/run/frame_store.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <zwang/core/files/problem_file.h>

namespace zwang::god {
namespace {

using Stored = hdf5::Group::Stored;

constexpr std::array all_columns = {
    Column{"t", "s", &Frame::time},
    Column{"gap", "m", &Frame::gap},
    Column{"depth", "m", &Frame::target_depth},
    Column{"joint", "m", &Frame::separation},
    Column{"limit", "rad", &Frame::limit},
    Column{"dist", "m", &Frame::distance},
    Column{"slide", "m", &Frame::lost_slide},
    Column{"jitter", "m", &Frame::jitter},
    Column{"work", "J", &Frame::work},
    Column{"impulse", "1", &Frame::impulse_error},
    Column{"speed", "m/s", &Frame::object_speed},
    Column{"rows", "1", nullptr, &Frame::rows},
    Column{"raw", "1", nullptr, &Frame::raw},
    Column{"kept", "1", nullptr, &Frame::kept},
    Column{"completed", "1", nullptr, &Frame::completed},
    Column{"sub", "1", nullptr, &Frame::sub_steps},
    Column{"returned", "1", nullptr, &Frame::returned},
    Column{"tracked", "1", nullptr, nullptr, &Frame::tracked},
    Column{"held", "1", nullptr, nullptr, &Frame::held},
    Column{"stuck", "1", nullptr, nullptr, &Frame::stuck},
    Column{"behind", "1", nullptr, nullptr, &Frame::behind},
};

// Everything that is stored of a frame, in one list for writing and for reading: visit(name, unit, value).
template <class SomeFrame, class Visit>
void each_of_frame(SomeFrame&& f, const Visit& visit) {
  visit("n", "1", f.number);
  for (const Column& c : all_columns) {
    if (c.number) visit(c.key, c.unit, f.*c.number);
    if (c.count) visit(c.key, c.unit, f.*c.count);
    if (c.flag) visit(c.key, c.unit, f.*c.flag);
  }
  visit("device", "N, N m", f.palm_wrench);
  visit("claimed", "1", f.claimed);
  visit("verified", "1", f.verified);
  visit("times", "s", f.times);
  visit("target", "m", f.target);
  visit("god", "m", f.god);
  visit("loose", "m", f.loose);
  visit("contacts", "1", f.contacts);
}

// Of a contact. Points are drawn, not computed with: single precision.
template <class SomeContact, class Visit>
void each_of_contact(SomeContact&& c, const Visit& visit) {
  visit("contact_body", "1", c.body);
  visit("contact_object", "1", c.object);
  visit("contact_point", "m", c.point);
  visit("contact_normal", "1", c.normal);
  visit("contact_gap", "m", c.gap);
  visit("contact_push", "N", c.push);
}

constexpr std::array stage_members = {&StageTimes::physics, &StageTimes::resolution, &StageTimes::assembly,
                                      &StageTimes::solve,   &StageTimes::search,     &StageTimes::completion,
                                      &StageTimes::sweep,   &StageTimes::other};

// A pose: position, quaternion x y z w.
constexpr std::size_t pose_numbers = 7;

// The rows of a value, and how it comes to doubles and back.
struct Put {
  std::vector<double>& out;
  template <class Number>
    requires std::is_arithmetic_v<Number>
  void operator()(Number x) const {
    out.push_back(static_cast<double>(x));
  }
  template <int N>
  void operator()(const Vec<double, N>& v) const {
    out.insert(out.end(), v.begin(), v.end());
  }
  void operator()(Status s) const { out.push_back(static_cast<double>(s)); }
  void operator()(const std::optional<Verdict>& v) const { out.push_back(v ? static_cast<double>(*v) : -1); }
  void operator()(const StageTimes& t) const {
    for (const auto stage : stage_members) out.push_back(t.*stage);
  }
  void operator()(const std::vector<Pose<double>>& poses) const {
    for (const Pose<double>& pose : poses) {
      const Eigen::Quaterniond q(pose.rotation);
      for (const double x : {pose.position.x(), pose.position.y(), pose.position.z(), q.x(), q.y(), q.z(), q.w()})
        out.push_back(x);
    }
  }
  void operator()(const std::vector<FrameContact>& contacts) const {
    out.push_back(static_cast<double>(contacts.size()));
  }
};

struct Take {
  const double*& at;
  template <class Number>
    requires std::is_arithmetic_v<Number>
  void operator()(Number& x) const {
    x = static_cast<Number>(*at++);
  }
  template <int N>
  void operator()(Vec<double, N>& v) const {
    for (double& x : v) x = *at++;
  }
  void operator()(Status& s) const { s = static_cast<Status>(*at++); }
  void operator()(std::optional<Verdict>& v) const {
    v = *at < 0 ? std::nullopt : std::optional(static_cast<Verdict>(*at));
    ++at;
  }
  void operator()(StageTimes& t) const {
    for (const auto stage : stage_members) t.*stage = *at++;
  }
  void operator()(std::vector<Pose<double>>& poses) const {
    for (Pose<double>& pose : poses) {
      pose = {{at[0], at[1], at[2]}, Eigen::Quaterniond(at[6], at[3], at[4], at[5]).normalized().toRotationMatrix()};
      at += pose_numbers;
    }
  }
  void operator()(std::vector<FrameContact>& contacts) const { contacts.resize(static_cast<std::size_t>(*at++)); }
};

template <class Enum>
std::string names_of(Enum last) {
  std::string names;
  for (int i = 0; i <= static_cast<int>(last); ++i)
    names += (i > 0 ? ", " : "") + std::to_string(i) + " " + std::string(to_string(static_cast<Enum>(i)));
  return names;
}

struct Create {
  hdf5::Group& file;
  bool single = false;  // reals in single precision

  template <class T>
  void operator()(const std::string& name, const char* unit, const T& value) const {
    Stored type = single ? Stored::single : Stored::real;
    std::vector<std::size_t> row;
    std::string meaning;
    if constexpr (std::is_same_v<T, bool>)
      type = Stored::flag;
    else if constexpr (std::is_integral_v<T> || std::is_same_v<T, std::vector<FrameContact>>)
      type = Stored::integer;
    else if constexpr (std::is_same_v<T, Status>)
      type = Stored::integer, meaning = names_of(Status::crashed);
    else if constexpr (std::is_same_v<T, std::optional<Verdict>>)
      type = Stored::integer, meaning = "-1 not looked at, " + names_of(Verdict::unsupported);
    else if constexpr (std::is_same_v<T, StageTimes>)
      row = {stage_members.size()}, meaning =
                                        "physics, resolution, assembly, solve, "
                                        "search, completion, sweep, other";
    else if constexpr (std::is_same_v<T, std::vector<Pose<double>>>)
      row = {value.size(), pose_numbers}, meaning = "position x y z, quaternion x y z w";
    else if constexpr (!std::is_arithmetic_v<T>)
      row = {static_cast<std::size_t>(value.size())};
    if (row.size() == 2 && row[0] == 0) return;
    file.add_rows(name, type, row);
    file.write_attribute(name, "unit", unit);
    if (!meaning.empty()) file.write_attribute(name, "meaning", meaning);
  }
};

Frame empty_frame(std::size_t bodies, std::size_t loose) {
  Frame frame;
  frame.target.resize(bodies);
  frame.god.resize(bodies);
  frame.loose.resize(loose);
  return frame;
}

std::filesystem::path file_of(const std::filesystem::path& directory) { return directory / "frames.h5"; }

// A new file, or one with the first `keep` frames of the old one, which it takes the place of.
hdf5::Group growing_file(const std::filesystem::path& directory, const Frame& empty, long keep) {
  const auto name = file_of(directory), draft = directory / "frames.h5.new";
  if (keep == 0) {
    hdf5::Group file = hdf5::Group::create_growing(name);
    each_of_frame(empty, Create{file});
    each_of_contact(FrameContact{}, Create{file, true});
    file.start_growing();
    return file;
  }
  const FrameReader reader(directory);
  if (reader.frames() < keep)
    throw BadFile(name.string() + ": holds " + std::to_string(reader.frames()) +
                  " whole frames, the checkpoint is after " + std::to_string(keep));
  const hdf5::Group old = hdf5::Group::open(name);
  double contacts = 0;
  for (const double n : old.read_rows("contacts", 0, static_cast<std::size_t>(keep))) contacts += n;
  hdf5::Group file = hdf5::Group::create_growing(draft);
  const auto copy = [&](double rows) {
    return [&, rows](const std::string& dataset, const char*, const auto& value) {
      if constexpr (std::is_same_v<decltype(value), const std::vector<Pose<double>>&>)
        if (value.empty()) return;
      file.copy_rows(old, dataset, static_cast<std::size_t>(rows));
    };
  };
  each_of_frame(empty, copy(static_cast<double>(keep)));
  each_of_contact(FrameContact{}, copy(contacts));
  file.flush();
  std::filesystem::rename(draft, name);
  file.start_growing();
  return file;
}

}  // namespace

std::span<const Column> columns() { return all_columns; }

FrameWriter::FrameWriter(const std::filesystem::path& directory, std::size_t bodies, std::size_t loose, long keep)
    : bodies_(bodies), loose_(loose), file_(growing_file(directory, empty_frame(bodies, loose), keep)) {
  const auto add = [this](const std::string& name, const char*, const auto&) { waiting_.push_back({name, {}}); };
  each_of_frame(Frame{}, add);
  each_of_contact(FrameContact{}, add);
}

void FrameWriter::write(const Frame& frame) {
  if (frame.target.size() != bodies_ || frame.god.size() != bodies_ || frame.loose.size() != loose_)
    throw std::logic_error("frame " + std::to_string(frame.number) + " has " + std::to_string(frame.god.size()) +
                           " god objects and " + std::to_string(frame.loose.size()) + " loose ones, the run " +
                           std::to_string(bodies_) + " and " + std::to_string(loose_));
  std::size_t at = 0;
  const auto put = [&](const char*, const char*, const auto& value) { Put{waiting_[at++].values}(value); };
  each_of_frame(frame, put);
  const std::size_t first = at;
  for (const FrameContact& contact : frame.contacts) {
    at = first;
    each_of_contact(contact, put);
  }
}

void FrameWriter::flush() {
  for (Dataset& dataset : waiting_) {
    if (!dataset.values.empty()) file_.append_rows(dataset.name, dataset.values);
    dataset.values.clear();
  }
  file_.flush();
}

FrameReader::FrameReader(const std::filesystem::path& directory) : file_(hdf5::Group::open(file_of(directory))) {
  std::size_t rows = ~std::size_t{0}, contacts = rows;
  const auto least = [this](std::size_t& of) {
    return [this, &of](const std::string& name, const char*, const auto&) {
      if (name == "loose" && !file_.has_data(name)) return;
      const std::vector<std::size_t> shape = file_.shape(name);
      of = std::min(of, shape.empty() ? 0 : shape[0]);
    };
  };
  each_of_frame(Frame{}, least(rows));
  each_of_contact(FrameContact{}, least(contacts));
  double held = 0;
  for (const double n : file_.read_rows("contacts", 0, rows)) {
    held += n;
    if (held > static_cast<double>(contacts)) break;
    ++frames_;
  }
}

void FrameReader::each(const std::function<void(const Frame&)>& visit) const {
  const auto bodies_in = [this](const char* name) {
    const std::vector<std::size_t> shape = file_.has_data(name) ? file_.shape(name) : std::vector<std::size_t>(3, 0);
    if (shape.size() != 3) file_.fail(name, "not of the right shape; expected frames x bodies x 7");
    return shape[1];
  };
  Frame frame = empty_frame(bodies_in("god"), bodies_in("loose"));
  std::vector<std::vector<double>> values;
  std::vector<const double*> at;
  std::size_t contacts = 0;
  for (long begin = 0; begin < frames_; begin += checkpoint_every) {
    const auto first = static_cast<std::size_t>(begin),
               count = static_cast<std::size_t>(std::min(checkpoint_every, frames_ - begin));
    values.clear();
    const auto read = [&](std::size_t from, std::size_t rows) {
      return [&, from, rows](const std::string& name, const char*, const auto&) {
        const bool there = rows > 0 && !(name == "loose" && frame.loose.empty());
        values.push_back(there ? file_.read_rows(name, from, rows) : std::vector<double>());
      };
    };
    each_of_frame(frame, read(first, count));
    double held = 0;
    for (const double n : values.back()) held += n;
    const auto here = static_cast<std::size_t>(held);
    each_of_contact(FrameContact{}, read(contacts, here));
    contacts += here;
    at.clear();
    for (const std::vector<double>& of : values) at.push_back(of.data());
    for (std::size_t k = 0; k < count; ++k) {
      std::size_t column = 0;
      const auto take = [&](const char*, const char*, auto& value) { Take{at[column++]}(value); };
      each_of_frame(frame, take);
      const std::size_t of_contacts = column;
      for (FrameContact& contact : frame.contacts) {
        column = of_contacts;
        each_of_contact(contact, take);
      }
      visit(frame);
    }
  }
}

void write_checkpoint(const std::filesystem::path& directory, const Checkpoint& checkpoint) {
  const auto file = directory / "checkpoint.h5", draft = directory / "checkpoint.h5.new";
  {
    hdf5::Group root = hdf5::Group::create(draft);
    root.write_one("frames", static_cast<std::uint64_t>(checkpoint.frames));
    root.write("state", std::span<const double>(checkpoint.state));
    root.flush();
  }
  std::filesystem::rename(draft, file);
}

Checkpoint read_checkpoint(const std::filesystem::path& directory) {
  const auto file = directory / "checkpoint.h5";
  if (!std::filesystem::exists(file)) return {};
  const hdf5::Group root = hdf5::Group::open(file);
  return {static_cast<long>(root.read_one<std::uint64_t>("frames")), root.read<double>("state")};
}

}  // namespace zwang::god
