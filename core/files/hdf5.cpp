#include <zwang/core/files/hdf5.h>

#include <hdf5.h>

#include <algorithm>
#include <cstring>
#include <type_traits>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/process/isolated.h>

namespace zwang::hdf5 {

static_assert(std::is_same_v<hid_t, std::int64_t>);

// An identifier of the library with the function that gives it back.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

namespace {

// A number's type in memory, and on disk: little-endian, whatever machine writes.
struct NumberType {
  hid_t memory, disk;
};
template <class T>
NumberType number_type() {
  if constexpr (std::is_same_v<T, double>) return {H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE};
  if constexpr (std::is_same_v<T, std::int64_t>) return {H5T_NATIVE_INT64, H5T_STD_I64LE};
  if constexpr (std::is_same_v<T, std::uint64_t>) return {H5T_NATIVE_UINT64, H5T_STD_U64LE};
  if constexpr (std::is_same_v<T, std::int32_t>) return {H5T_NATIVE_INT32, H5T_STD_I32LE};
  if constexpr (std::is_same_v<T, std::uint32_t>) return {H5T_NATIVE_UINT32, H5T_STD_U32LE};
  return {H5T_NATIVE_UINT8, H5T_STD_U8LE};
}

// The library prints a stack of its own for every failure; ours is one line. As the program ends it crashes over a file
// that it could not write, which it is told to leave alone.
void silence() {
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

H5O_type_t type_of(hid_t group, const std::string& name) {
  H5O_info_t info;
  const bool found = H5Lexists(group, name.c_str(), H5P_DEFAULT) > 0 &&
                     H5Oget_info_by_name2(group, name.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT) >= 0;
  return found ? info.type : H5O_TYPE_UNKNOWN;
}

// Adds the name of a link or an attribute to a list.
constexpr auto collect = [](hid_t, const char* name, const auto*, void* into) -> herr_t {
  static_cast<std::vector<std::string>*>(into)->emplace_back(name);
  return 0;
};

std::vector<hsize_t> extent(hid_t space) {
  std::vector<hsize_t> size(at(std::max(0, H5Sget_simple_extent_ndims(space))));
  H5Sget_simple_extent_dims(space, size.data(), nullptr);
  return size;
}

// gzip's best ratio: what n stored bytes can grow to.
constexpr std::uintmax_t largest_expansion = 1032;
// Groups within groups that a problem, a collection or a run has, and some to spare. (Links may form a circle.)
constexpr int deepest = 6;
// From 1 ns on the last pause is then 1 ms.
constexpr unsigned most_attempts = 20;

}  // namespace

struct Group::File {
  std::string name;
  std::uintmax_t bytes;
};

// An open dataset of n elements, or where there is none an attribute of its group, known to be no larger than its file
// can hold.
struct Group::Dataset {
  bool attribute;
  Handle id, space, type;
  std::vector<hsize_t> dims;
  std::size_t n;

  // Where types differ HDF5 zeroes a megabyte for the numbers on their way, unless it is told that fewer will do.
  herr_t read(hid_t as, void* into) const {
    if (attribute) return H5Aread(id, as, into);
    constexpr std::size_t usual = 1 << 20, of_text_in_file = 16;  // bytes; of text here: a pointer
    const std::size_t width = std::max({H5Tget_size(type), H5Tget_size(as), of_text_in_file});
    const Handle way(H5Pcreate(H5P_DATASET_XFER), H5Pclose);
    if (n < usual / width) H5Pset_buffer(way, std::max<std::size_t>(n, 1) * width, nullptr, nullptr);
    return H5Dread(id, as, H5S_ALL, H5S_ALL, way, into);
  }

  Dataset(const Group& group, const std::string& name)
      : attribute(type_of(*group.id_, name) != H5O_TYPE_DATASET),
        id(!attribute                                ? H5Dopen2(*group.id_, name.c_str(), H5P_DEFAULT)
           : H5Aexists(*group.id_, name.c_str()) > 0 ? H5Aopen(*group.id_, name.c_str(), H5P_DEFAULT)
                                                     : -1,
           attribute ? H5Aclose : H5Dclose),
        space(id < 0 ? -1 : (attribute ? H5Aget_space : H5Dget_space)(id), H5Sclose),
        type(id < 0 ? -1 : (attribute ? H5Aget_type : H5Dget_type)(id), H5Tclose) {
    if (id < 0) group.fail(name, "missing; expected a dataset");
    if (space < 0 || type < 0) group.fail(name, "damaged; expected a dataset with a shape and a type");
    dims = extent(space);
    const std::size_t width = std::max<std::size_t>(H5Tget_size(type), 1);
    const std::uintmax_t most = largest_expansion * group.file_->bytes / width;
    n = H5Sget_simple_extent_type(space) == H5S_NULL ? 0 : 1;
    for (const hsize_t d : dims) {
      if (d != 0 && n > most / d)
        group.fail(name, "more elements than the file can hold; expected an undamaged dataset");
      n *= d;
    }
    if (n > 0 && !attribute && H5Dget_storage_size(id) == 0)
      group.fail(name, "declared but never written; expected its numbers");
  }
};

std::string Group::path_to(const std::string& name) const {
  if (name.empty()) return path_;
  return (path_ == "/" ? "" : path_) + "/" + name;
}

void Group::fail(const std::string& name, const std::string& what) const {
  throw BadFile(file_->name + ": " + path_to(name) + ": " + what);
}

Group Group::open(const std::filesystem::path& file) {
  std::error_code absent;
  const auto bytes = static_cast<double>(std::filesystem::file_size(file, absent));
  if (!absent)
    isolated(file, {.seconds = 5 + bytes / 5e6, .bytes = (std::size_t{1} << 30) + static_cast<std::size_t>(20 * bytes)},
             [&file] {
               open_here(file).rehearse(deepest);
               return std::string();
             });
  return open_here(file);
}

// What cannot be read is passed over: it may not be needed.
void Group::rehearse(int depth) const {
  const auto attempt = [](const auto& reading) {
    try {
      reading();
    } catch (const BadFile&) {
    }
  };
  std::vector<std::string> names;
  attempt([&] { names = links(); });
  attempt([&] { std::ranges::copy(attributes(), std::back_inserter(names)); });
  for (const std::string& name : names) {
    if (depth > 0) attempt([&] { group(name).rehearse(depth - 1); });
    attempt([&] { read<double>(name); });
    attempt([&] { read<std::int64_t>(name); });
    attempt([&] { read_strings(name); });
  }
}

Group Group::open_here(const std::filesystem::path& file) {
  silence();
  std::error_code error;
  const std::string name = file.string();
  if (!std::filesystem::exists(file, error)) throw BadFile(name + ": no such file; expected an HDF5 file");
  if (!std::filesystem::is_regular_file(file, error)) throw BadFile(name + ": not a file; expected an HDF5 file");
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (H5Fis_hdf5(name.c_str()) <= 0) throw BadFile(name + ": not HDF5, or unreadable; expected an HDF5 file");
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access, false, true);
  hid_t id = H5Fopen(name.c_str(), H5F_ACC_RDONLY, access);
  if (id < 0) {  // its writer was killed
    // A damaged block is read again, for a writer might be at work: after a pause that doubles each time, 100 times.
    H5Pset_metadata_read_attempts(access, most_attempts);
    id = H5Fopen(name.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access);
  }
  if (id < 0) throw BadFile(name + ": truncated or damaged; expected a complete HDF5 file");
  return {std::make_shared<File>(name, bytes), std::make_shared<Handle>(id, H5Fclose), "/"};
}

Group Group::create(const std::filesystem::path& file, bool growing, const std::string& name) {
  const std::string called = name.empty() ? file.string() : name;
  silence();
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (growing) H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
  const hid_t id = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  if (id < 0) throw BadFile(called + ": cannot be written; expected a folder that exists and may be written to");
  return {std::make_shared<File>(called, 0), std::make_shared<Handle>(id, H5Fclose), "/"};
}

void Group::require_written(bool done, const std::string& name) const {
  if (!done) fail(name, "cannot be written; expected room on the disk");
}

void Group::start_growing() { require_written(H5Fstart_swmr_write(*id_) >= 0); }

bool Group::has_group(const std::string& name) const { return type_of(*id_, name) == H5O_TYPE_GROUP; }

bool Group::has_data(const std::string& name) const {
  if (type_of(*id_, name) != H5O_TYPE_DATASET) return false;
  const Handle id(H5Dopen2(*id_, name.c_str(), H5P_DEFAULT), H5Dclose);
  const Handle space(id < 0 ? -1 : H5Dget_space(id), H5Sclose);
  return space < 0 || H5Sget_simple_extent_npoints(space) == 0 || H5Dget_storage_size(id) > 0;
}

Group Group::group(const std::string& name) const {
  const hid_t id = has_group(name) ? H5Gopen2(*id_, name.c_str(), H5P_DEFAULT) : -1;
  if (id < 0) fail(name, "missing; expected a group");
  return {file_, std::make_shared<Handle>(id, H5Gclose), path_to(name)};
}

std::vector<std::string> Group::links() const {
  std::vector<std::string> names;
  if (H5Literate(*id_, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names) < 0)
    fail("", "its list of contents is damaged; expected a readable group");
  return names;
}

std::vector<std::string> Group::attributes() const {
  std::vector<std::string> names;
  if (H5Aiterate2(*id_, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names) < 0)
    fail("", "its list of attributes is damaged; expected a readable group");
  return names;
}

bool Group::holds_text(const std::string& name) const { return H5Tget_class(Dataset(*this, name).type) == H5T_STRING; }

std::vector<std::string> Group::groups() const {
  std::vector<std::string> names;
  std::ranges::copy_if(links(), std::back_inserter(names), [&](const std::string& name) { return has_group(name); });
  std::ranges::sort(names, [](const auto& a, const auto& b) { return strverscmp(a.c_str(), b.c_str()) < 0; });
  return names;
}

std::vector<std::size_t> Group::shape(const std::string& name) const {
  const Dataset data(*this, name);
  return {data.dims.begin(), data.dims.end()};
}

template <class T>
std::vector<T> Group::read(const std::string& name, std::size_t expected) const {
  const Dataset data(*this, name);
  if (expected != any && data.n != expected)
    fail(name, "holds " + std::to_string(data.n) + " numbers; expected " + std::to_string(expected));
  const H5T_class_t kind = H5Tget_class(data.type);
  const bool whole = kind == H5T_INTEGER || kind == H5T_ENUM;
  if (!whole && !(std::is_same_v<T, double> && kind == H5T_FLOAT))
    fail(name, std::string("not of the right type; expected ") + (std::is_same_v<T, double> ? "numbers" : "integers"));
  std::vector<T> values(data.n);
  if (data.n > 0 && data.read(number_type<T>().memory, values.data()) < 0)
    fail(name, "cannot be read (damaged, or compressed by a filter that is not installed); expected " +
                   std::to_string(data.n) + " numbers");
  return values;
}

std::vector<std::string> Group::read_strings(const std::string& name) const {
  const Dataset data(*this, name);
  if (H5Tget_class(data.type) != H5T_STRING) fail(name, "not of the right type; expected text");
  std::vector<std::string> texts(data.n);
  if (data.n == 0) return texts;
  const Handle type(H5Tcopy(data.type), H5Tclose);
  if (H5Tis_variable_str(data.type) > 0) {
    std::vector<char*> raw(data.n, nullptr);
    if (data.read(type, raw.data()) < 0) fail(name, "damaged; expected text");
    for (std::size_t i = 0; i < data.n; ++i) texts[i] = raw[i] ? raw[i] : "";
    H5Dvlen_reclaim(type, data.space, H5P_DEFAULT, raw.data());
  } else {
    const std::size_t width = H5Tget_size(type);
    std::string raw(width * data.n, '\0');
    if (data.read(type, raw.data()) < 0) fail(name, "damaged; expected text");
    for (std::size_t i = 0; i < data.n; ++i) texts[i] = raw.substr(i * width, width).c_str();
  }
  return texts;
}

Group Group::add_group(const std::string& name) {
  const hid_t id = H5Gcreate2(*id_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  require_written(id >= 0, name);
  return {file_, std::make_shared<Handle>(id, H5Gclose), path_to(name)};
}

// No time stamps: the same contents give the same bytes.
void Group::write_raw(const std::string& name, std::int64_t disk, std::int64_t memory, std::size_t n,
                      const void* data) {
  const hsize_t dim = n;
  const Handle space(H5Screate_simple(1, &dim, nullptr), H5Sclose), settings(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(settings, false);
  const Handle id(H5Dcreate2(*id_, name.c_str(), disk, space, H5P_DEFAULT, settings, H5P_DEFAULT), H5Dclose);
  require_written(id >= 0 && (n == 0 || H5Dwrite(id, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0), name);
}

template <class T>
void Group::write(const std::string& name, std::span<const T> values) {
  const auto [memory, disk] = number_type<T>();
  write_raw(name, disk, memory, values.size(), values.data());
}

void Group::write_strings(const std::string& name, std::span<const std::string> texts) {
  std::size_t width = 1;
  for (const std::string& text : texts) width = std::max(width, text.size());
  std::string raw(width * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i].copy(raw.data() + i * width, width);
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, width);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  write_raw(name, type, type, texts.size(), raw.data());
}

void Group::flush() { require_written(H5Fflush(*id_, H5F_SCOPE_GLOBAL) >= 0); }

void Group::add_rows(const std::string& name, Stored type, const std::vector<std::size_t>& row) {
  constexpr hsize_t chunk_bytes = 1 << 16, chunk_rows = 512;
  const hid_t types[] = {H5T_IEEE_F64LE, H5T_IEEE_F32LE, H5T_STD_I32LE, H5T_STD_U8LE};
  const hid_t disk = types[static_cast<std::size_t>(type)];
  std::vector<hsize_t> size = {0}, chunk = {1}, most = {H5S_UNLIMITED};
  hsize_t bytes = H5Tget_size(disk);
  for (const std::size_t n : row) size.push_back(n), chunk.push_back(n), most.push_back(n), bytes *= n;
  chunk[0] = std::clamp<hsize_t>(chunk_bytes / bytes, 1, chunk_rows);
  const int rank = static_cast<int>(size.size());
  const Handle space(H5Screate_simple(rank, size.data(), most.data()), H5Sclose),
      settings(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(settings, false);
  H5Pset_chunk(settings, rank, chunk.data());
  H5Pset_fletcher32(settings);  // a damaged byte makes reading fail
  const Handle id(H5Dcreate2(*id_, name.c_str(), disk, space, H5P_DEFAULT, settings, H5P_DEFAULT), H5Dclose);
  require_written(id >= 0, name);
}

void Group::append_rows(const std::string& name, std::span<const double> values) {
  const Handle id(H5Dopen2(*id_, name.c_str(), H5P_DEFAULT), H5Dclose);
  std::vector<hsize_t> size = extent(Handle(H5Dget_space(id), H5Sclose));
  hsize_t numbers = 1;
  for (std::size_t k = 1; k < size.size(); ++k) numbers *= size[k];
  if (values.size() % numbers != 0) fail(name, "not whole rows");
  std::vector<hsize_t> first(size.size(), 0), count = size;
  first[0] = size[0];
  count[0] = values.size() / numbers;
  size[0] += count[0];
  if (count[0] == 0) return;
  require_written(H5Dset_extent(id, size.data()) >= 0, name);
  const Handle space(H5Dget_space(id), H5Sclose),
      memory(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose);
  H5Sselect_hyperslab(space, H5S_SELECT_SET, first.data(), nullptr, count.data(), nullptr);
  require_written(H5Dwrite(id, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values.data()) >= 0, name);
}

std::vector<double> Group::read_rows(const std::string& name, std::size_t first, std::size_t count) const {
  const Dataset data(*this, name);
  const H5T_class_t kind = H5Tget_class(data.type);
  if (kind != H5T_INTEGER && kind != H5T_FLOAT) fail(name, "not of the right type; expected numbers");
  if (data.dims.empty() || first + count > data.dims[0])
    fail(name, "too short; expected " + std::to_string(first + count) + " rows");
  std::vector<hsize_t> from(data.dims.size(), 0), size = data.dims;
  from[0] = first;
  size[0] = count;
  std::vector<double> values(data.dims[0] == 0 ? 0 : data.n / data.dims[0] * count);
  if (values.empty()) return values;
  const Handle memory(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
  H5Sselect_hyperslab(data.space, H5S_SELECT_SET, from.data(), nullptr, size.data(), nullptr);
  if (H5Dread(data.id, H5T_NATIVE_DOUBLE, memory, data.space, H5P_DEFAULT, values.data()) < 0)
    fail(name, "cannot be read; expected " + std::to_string(values.size()) + " numbers");
  return values;
}

void Group::write_attribute(const std::string& dataset, const std::string& name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  const char* characters = text.c_str();
  const Handle id(
      H5Acreate_by_name(*id_, dataset.c_str(), name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  require_written(id >= 0 && H5Awrite(id, type, &characters) >= 0, dataset);
}

template std::vector<double> Group::read(const std::string&, std::size_t) const;
template std::vector<std::int64_t> Group::read(const std::string&, std::size_t) const;
template std::vector<std::uint64_t> Group::read(const std::string&, std::size_t) const;
template void Group::write(const std::string&, std::span<const double>);
template void Group::write(const std::string&, std::span<const std::int64_t>);
template void Group::write(const std::string&, std::span<const std::int32_t>);
template void Group::write(const std::string&, std::span<const std::uint64_t>);
template void Group::write(const std::string&, std::span<const std::uint32_t>);
template void Group::write(const std::string&, std::span<const std::uint8_t>);

}  // namespace zwang::hdf5
