#include <zwang/experiments/god_hand/run/frame_store.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/mix_bits.h>
#include <zwang/core/problem/wording.h>
#include <zwang/experiments/god_hand/hand/each_number.h>

namespace zwang::god {
namespace {

using Stored = hdf5::Group::Stored;
using Poses = std::vector<Pose<double>>;

constexpr std::array stage_members = {&StageTimes::physics, &StageTimes::resolution, &StageTimes::assembly,
                                      &StageTimes::solve,   &StageTimes::search,     &StageTimes::completion,
                                      &StageTimes::sweep,   &StageTimes::other};
constexpr std::size_t pose_numbers = 7;  // position, quaternion x y z w

// visit(number) for every number that is stored of a value, in order; a value that is not const becomes what it left.
template <class T, class Visit>
void each_stored(T& value, const Visit& visit) {
  using Plain = std::remove_const_t<T>;
  constexpr bool taken = !std::is_const_v<T>;
  if constexpr (std::is_same_v<Plain, std::optional<Verdict>>) {
    int verdict = value ? static_cast<int>(*value) : -1;
    visit(verdict);
    if constexpr (taken) value = verdict < 0 ? std::nullopt : std::optional(static_cast<Verdict>(verdict));
  } else if constexpr (std::is_same_v<Plain, std::vector<FrameContact>>) {
    std::size_t count = value.size();
    visit(count);
    if constexpr (taken) value.resize(count);
  } else if constexpr (std::is_same_v<Plain, StageTimes>) {
    for (const auto stage : stage_members) visit(value.*stage);
  } else if constexpr (std::is_same_v<Plain, Poses>) {
    for (auto& pose : value) {
      Vec<double, pose_numbers> n;
      n << pose.position, Eigen::Quaterniond(pose.rotation).coeffs();
      each_number(n, visit);
      if constexpr (taken)
        pose = {n.head<3>(), Eigen::Quaterniond(n[6], n[3], n[4], n[5]).normalized().toRotationMatrix()};
    }
  } else {
    each_number(value, visit);
  }
}

template <class Enum>
std::string names_of(Enum last) {
  return joined(mapped(numbers_from(0, at(static_cast<int>(last) + 1)),
                       [](int i) { return std::to_string(i) + " " + std::string(to_string(static_cast<Enum>(i))); }));
}

// How a value of this type is stored; an empty list of poses is not.
template <class T>
Dataset dataset_of(const char* name, const char* unit, const T& value, Stored reals) {
  std::size_t numbers = 0;
  each_stored(value, [&](const auto&) { ++numbers; });
  Dataset d{.name = name, .unit = unit, .type = reals};
  if (numbers > 1) d.row = {numbers};
  if constexpr (std::is_same_v<T, bool>)
    d.type = Stored::flag;
  else if constexpr (std::is_integral_v<T> || std::is_same_v<T, std::vector<FrameContact>>)
    d.type = Stored::integer;
  else if constexpr (std::is_same_v<T, Origin>)
    d.type = Stored::integer, d.meaning = names_of(Origin::limited);
  else if constexpr (std::is_same_v<T, Status>)
    d.type = Stored::integer, d.meaning = names_of(Status::crashed);
  else if constexpr (std::is_same_v<T, std::optional<Verdict>>)
    d.type = Stored::integer, d.meaning = "-1 not looked at, " + names_of(last_verdict);
  else if constexpr (std::is_same_v<T, StageTimes>)
    d.meaning = "physics, resolution, assembly, solve, search, completion, sweep, other";
  else if constexpr (std::is_same_v<T, Poses>)
    d.row = {value.size(), pose_numbers}, d.meaning = "position x y z, quaternion x y z w";
  return d;
}

Frame empty_frame(std::size_t bodies, std::size_t loose) {
  Frame frame;
  frame.target.resize(bodies);
  frame.god.resize(bodies);
  frame.loose.resize(loose);
  return frame;
}

// Everything that is stored of a frame, in one list for writing and for reading.
std::vector<Dataset> datasets(std::size_t bodies, std::size_t loose) {
  std::vector<Dataset> all;
  const std::tuple<Frame, FrameContact> empty(empty_frame(bodies, loose), {});
  // A member of frames, or of their contacts, whose points are drawn, not computed with: single precision.
  const auto add = [&]<class Of, class T>(const char* name, const char* unit, T Of::* member) {
    constexpr bool of_contacts = std::is_same_v<Of, FrameContact>;
    const auto each = [member](auto& frame, const auto& visit) {
      if constexpr (of_contacts)
        for (auto& contact : frame.contacts) each_stored(contact.*member, visit);
      else
        each_stored(frame.*member, visit);
    };
    Dataset& d = all.emplace_back(
        dataset_of(name, unit, std::get<Of>(empty).*member, of_contacts ? Stored::single : Stored::real));
    d.of_contacts = of_contacts;
    d.put = [each](const Frame& f, std::vector<double>& out) { each(f, write_numbers(out)); };
    d.take = [each](Frame& f, const double*& at) { each(f, take_numbers(at)); };
  };
  add("n", "1", &Frame::number);
  for (const Column& c : columns()) std::visit([&](auto member) { add(c.key, c.unit, member); }, c.member);
  add("device", "N, N m", &Frame::palm_wrench);
  add("claimed", "1", &Frame::claimed);
  add("verified", "1", &Frame::verified);
  add("times", "s", &Frame::times);
  add("target", "m", &Frame::target);
  add("god", "m", &Frame::god);
  if (loose > 0) add("loose", "m", &Frame::loose);
  add("contacts", "1", &Frame::contacts);
  add("contact_body", "1", &FrameContact::body);
  add("contact_object", "1", &FrameContact::object);
  add("contact_point", "m", &FrameContact::point);
  add("contact_normal", "1", &FrameContact::normal);
  add("contact_gap", "m", &FrameContact::gap);
  add("contact_push", "N", &FrameContact::push);
  add("contact_friction", "N", &FrameContact::friction);
  return all;
}

std::filesystem::path file_of(const std::filesystem::path& directory) { return directory / "frames.h5"; }

std::size_t contacts_in(const hdf5::Group& file, std::size_t first, std::size_t frames) {
  const std::vector<double> counts = file.read_rows("contacts", first, frames);
  return static_cast<std::size_t>(std::accumulate(counts.begin(), counts.end(), 0.0));
}

// How many there are in a row of poses.
std::size_t poses_in(const hdf5::Group& file, const std::string& name) {
  const std::vector<std::size_t> shape = file.has_data(name) ? file.shape(name) : std::vector<std::size_t>();
  return shape.size() > 1 ? shape[1] : 0;
}

// How many a dataset has.
std::size_t rows_of(const hdf5::Group& file, const Dataset& d) {
  const std::vector<std::size_t> shape = file.shape(d.name);
  if (shape.empty() || !std::ranges::equal(std::span(shape).subspan(1), d.row))
    file.fail(d.name, "its rows are not of the expected shape");
  return shape[0];
}

// A new file, or one with the first `keep` frames of the old one, which it takes the place of.
hdf5::Group growing_file(const std::filesystem::path& directory, const std::vector<Dataset>& datasets, long keep) {
  constexpr std::size_t block = 4096;  // rows that are copied at once
  const auto name = file_of(directory), draft = directory / "frames.h5.new";
  std::optional<FrameReader> old;
  if (keep > 0) old.emplace(directory);
  if (old && old->frames() < keep)
    throw BadFile(name.string() + ": holds " + std::to_string(old->frames()) +
                  " whole frames, the checkpoint is after " + std::to_string(keep));
  if (old)
    for (const Dataset& d : datasets) rows_of(old->file(), d);
  hdf5::Group file = hdf5::Group::create(old ? draft : name, true);
  for (const Dataset& d : datasets) {
    file.add_rows(d.name, d.type, d.row);
    file.write_attribute(d.name, "unit", d.unit);
    if (!d.meaning.empty()) file.write_attribute(d.name, "meaning", d.meaning);
  }
  if (old) {
    const auto frames = static_cast<std::size_t>(keep), contacts = contacts_in(old->file(), 0, frames);
    for (const Dataset& d : datasets)
      for (std::size_t first = 0, rows = d.of_contacts ? contacts : frames; first < rows; first += block)
        file.append_rows(d.name, old->file().read_rows(d.name, first, std::min(block, rows - first)));
    file.flush();
    std::filesystem::rename(draft, name);
  }
  file.start_growing();
  return file;
}

// Of all else that is stored: a simulation may never end in a state that is not the one written.
std::uint64_t checksum(const Checkpoint& c) {
  return fnv1a({reinterpret_cast<const char*>(c.state.data()), c.state.size() * sizeof(double)},
               mix_bits(static_cast<std::uint64_t>(c.frames)));
}

}  // namespace

FrameWriter::FrameWriter(const std::filesystem::path& directory, std::size_t bodies, std::size_t loose, long keep)
    : bodies_(bodies),
      loose_(loose),
      datasets_(datasets(bodies, loose)),
      waiting_(datasets_.size()),
      file_(growing_file(directory, datasets_, keep)) {}

void FrameWriter::write(const Frame& frame) {
  if (frame.target.size() != bodies_ || frame.god.size() != bodies_ || frame.loose.size() != loose_)
    throw std::logic_error("frame " + std::to_string(frame.number) + " has " + std::to_string(frame.god.size()) +
                           " god objects and " + std::to_string(frame.loose.size()) + " loose ones, the run " +
                           std::to_string(bodies_) + " and " + std::to_string(loose_));
  for (std::size_t k = 0; k < datasets_.size(); ++k) datasets_[k].put(frame, waiting_[k]);
}

void FrameWriter::flush() {
  for (std::size_t k = 0; k < datasets_.size(); ++k) {
    if (!waiting_[k].empty()) file_.append_rows(datasets_[k].name, waiting_[k]);
    waiting_[k].clear();
  }
  file_.flush();
}

FrameReader::FrameReader(const std::filesystem::path& directory)
    : file_(hdf5::Group::open(file_of(directory))),
      bodies_(poses_in(file_, "god")),
      loose_(poses_in(file_, "loose")),
      datasets_(datasets(bodies_, loose_)) {
  // Names have no checksum; a list of poses that is not there would count as empty.
  for (const std::string& name : file_.links())
    if (std::ranges::none_of(datasets_, [&](const Dataset& d) { return d.name == name; }))
      file_.fail(name, "not a dataset of a run");
  std::size_t frames = ~std::size_t{0}, contacts = frames;
  for (const Dataset& d : datasets_) {
    std::size_t& least = d.of_contacts ? contacts : frames;
    least = std::min(least, rows_of(file_, d));
  }
  double held = 0;
  for (const double n : file_.read_rows("contacts", 0, frames)) {
    held += n;
    if (!(n >= 0) || held > static_cast<double>(contacts)) break;
    ++frames_;
  }
}

void FrameReader::each(const std::function<void(const Frame&)>& visit) const {
  Frame frame = empty_frame(bodies_, loose_);
  std::size_t first_contact = 0;
  for (long begin = 0; begin < frames_; begin += checkpoint_every) {
    const auto first = at(begin), count = at(std::min(checkpoint_every, frames_ - begin)),
               contacts = contacts_in(file_, first, count);
    std::vector<std::vector<double>> values;
    std::vector<const double*> at;
    for (const Dataset& d : datasets_) {
      values.push_back(!d.of_contacts ? file_.read_rows(d.name, first, count)
                       : contacts > 0 ? file_.read_rows(d.name, first_contact, contacts)
                                      : std::vector<double>());
      at.push_back(values.back().data());
      if (d.name == "times" && std::ranges::any_of(values.back(), [](double t) { return !std::isfinite(t); }))
        file_.fail(d.name, "not a number or infinite; expected seconds");
    }
    first_contact += contacts;
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t d = 0; d < datasets_.size(); ++d) datasets_[d].take(frame, at[d]);
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
    root.write_one("checksum", checksum(checkpoint));
    root.flush();
  }
  std::filesystem::rename(draft, file);
}

Checkpoint read_checkpoint(const std::filesystem::path& directory) {
  const auto file = directory / "checkpoint.h5";
  if (!std::filesystem::exists(file)) return {};
  const hdf5::Group root = hdf5::Group::open(file);
  Checkpoint checkpoint{static_cast<long>(root.read_one<std::uint64_t>("frames")), root.read<double>("state")};
  if (root.read_one<std::uint64_t>("checksum") != checksum(checkpoint))
    root.fail("checksum", "does not fit the state; expected an undamaged checkpoint");
  return checkpoint;
}

}  // namespace zwang::god
