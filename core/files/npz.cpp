#include <zwang/core/files/npz.h>

#include <zlib.h>

#include <bit>
#include <charconv>
#include <cstdint>
#include <set>
#include <string_view>

#include <zwang/core/files/problem_file.h>

namespace zwang {
namespace {

constexpr std::size_t largest_expansion = 1032;  // of zlib: what a stored byte can grow to

// Bytes of a file, or of a member of it, never read beyond their end.
class Bytes {
 public:
  Bytes(std::string_view all, std::string who) : all_(all), who_(std::move(who)) {}

  [[noreturn]] void refuse(const std::string& why) const { throw BadFile(one_line(who_ + ": " + why)); }
  void require(bool holds) const {
    if (!holds) refuse("cut off or damaged; expected a whole archive of numpy.savez");
  }
  std::string_view all() const { return all_; }
  std::string_view at(std::size_t begin, std::size_t count) const {
    require(begin <= all_.size() && count <= all_.size() - begin);
    return all_.substr(begin, count);
  }
  std::uint64_t number(std::size_t begin, std::size_t bytes, bool big_end_first = false) const {
    const std::string_view part = at(begin, bytes);
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < bytes; ++k)
      bits = bits << 8 | static_cast<unsigned char>(part[big_end_first ? k : bytes - 1 - k]);
    return bits;
  }

 private:
  std::string_view all_;
  std::string who_;
};

std::string inflated(const Bytes& member, std::size_t size) {
  std::string out(size, '\0');
  z_stream stream = {};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) member.refuse("zlib cannot start");
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(member.all().data()));
  stream.avail_in = static_cast<uInt>(member.all().size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(size);
  const int status = inflate(&stream, Z_FINISH);
  const bool whole = status == Z_STREAM_END && stream.avail_out == 0;
  inflateEnd(&stream);
  member.require(whole);
  return out;
}

void append_utf8(std::string& text, std::uint64_t code) {
  if (code < 0x80) {
    text += static_cast<char>(code);
    return;
  }
  int more = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
  text += static_cast<char>((0xff00 >> (more + 1) & 0xff) | code >> 6 * more);
  while (more-- > 0) text += static_cast<char>(0x80 | (code >> 6 * more & 0x3f));
}

double value_of(char kind, std::size_t width, std::uint64_t bits) {
  if (kind == 'f')
    return width == 8 ? std::bit_cast<double>(bits) : std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  const std::size_t unused = 64 - 8 * width;
  return kind == 'i' ? static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused)
                     : static_cast<double>(bits);
}

// A header like {'descr': '<f8', 'fortran_order': False, 'shape': (3,), }, then the data.
NamedArray parse_array(const Bytes& npy, std::string name) {
  if (!npy.all().starts_with("\x93NUMPY")) npy.refuse("expected an array of NumPy");
  const bool is_long = npy.number(6, 1) > 1;
  const std::size_t begin = is_long ? 12 : 10, end = begin + npy.number(8, is_long ? 4 : 2);
  const std::string_view header = npy.at(begin, end - begin);
  const auto value = [&](std::string_view before, char after) {
    const std::size_t from = header.find(before);
    if (from == header.npos) npy.refuse("expected a type and a shape of NumPy, " + std::string(before));
    return header.substr(from + before.size(), header.find(after, from + before.size()) - from - before.size());
  };
  const auto count_in = [](std::string_view text, std::string_view behind, std::size_t& count) {
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    return error == std::errc() && text.substr(static_cast<std::size_t>(stop - text.data())) == behind;
  };
  const std::string_view type = value("'descr': '", '\''), shape = value("'shape': (", ')');
  NamedArray array{.name = std::move(name), .is_scalar = shape.empty()};
  std::size_t count = 1, width = 0;
  if (!array.is_scalar && !count_in(shape, ",", count)) npy.refuse("expected one dimension or none");
  const char kind = type.size() > 2 && count_in(type.substr(2), "", width) ? type[1] : ' ';
  const bool big = type.starts_with('>');
  array.is_text = array.is_scalar && (kind == 'U' || kind == 'S');
  const bool known = array.is_text || (kind == 'f' && (width == 4 || width == 8)) || (kind == 'b' && width == 1) ||
                     ((kind == 'i' || kind == 'u') && (width == 1 || width == 2 || width == 4 || width == 8));
  if (!known) npy.refuse("type " + std::string(type) + "; expected numbers or one text");
  if (array.is_text) {
    const std::size_t bytes = kind == 'U' ? 4 : 1;
    npy.require(width <= npy.all().size() / bytes);
    for (std::size_t k = 0; k < width; ++k) {
      const std::uint64_t code = npy.number(end + k * bytes, bytes, big);
      if (code == 0) break;
      if (bytes == 4)
        append_utf8(array.text, code);
      else
        array.text += static_cast<char>(code);
    }
    return array;
  }
  npy.require(count <= npy.all().size() / width);
  npy.at(end, count * width);
  array.numbers.reserve(count);
  for (std::size_t k = 0; k < count; ++k)
    array.numbers.push_back(value_of(kind, width, npy.number(end + k * width, width, big)));
  return array;
}

}  // namespace

bool is_npz(const StoredFile& file) { return file.bytes.starts_with("PK\3\4") || file.bytes.starts_with("PK\5\6"); }

// https://pkware.cachefly.net/webdocs/casestudies/APPNOTE.TXT: the directory is at the end, and counts.
std::vector<NamedArray> read_npz(const StoredFile& file) {
  const Bytes zip(file.bytes, file.path.string());
  std::size_t end = file.bytes.rfind("PK\5\6");
  zip.require(end != std::string::npos);
  std::uint64_t count = zip.number(end + 10, 2), at = zip.number(end + 16, 4);
  if (end >= 20 && zip.at(end - 20, 4) == "PK\6\7") {  // more than 65,535 members, or 4 GB
    const std::uint64_t wide = zip.number(end - 12, 8);
    zip.require(zip.at(wide, 4) == "PK\6\6");
    count = zip.number(wide + 32, 8);
    at = zip.number(wide + 48, 8);
  }
  std::vector<NamedArray> arrays;
  std::set<std::string> names;
  std::uint64_t all = 0;  // bytes of the members: they cannot lie in one another
  for (; count > 0; --count) {
    zip.require(zip.at(at, 4) == "PK\1\2");
    const std::uint64_t flags = zip.number(at + 8, 2), method = zip.number(at + 10, 2), crc = zip.number(at + 16, 4);
    const std::uint64_t name_size = zip.number(at + 28, 2), more = zip.number(at + 30, 2);
    std::uint64_t packed = zip.number(at + 20, 4), size = zip.number(at + 24, 4), local = zip.number(at + 42, 4);
    std::string name(zip.at(at + 46, name_size));
    if (std::uint64_t wide = at + 46 + name_size; more >= 4 && zip.number(wide, 2) == 1)  // what 32 bits cannot hold
      for (std::uint64_t* field : {&size, &packed, &local})
        if (*field == 0xffffffff) *field = zip.number((wide += 8) - 4, 8);
    at += 46 + name_size + more + zip.number(at + 32, 2);
    if (name.ends_with(".npy")) name.resize(name.size() - 4);
    const std::string who = file.path.string() + ", " + name;
    zip.require(zip.at(local, 4) == "PK\3\4");
    const Bytes member(zip.at(local + 30 + zip.number(local + 26, 2) + zip.number(local + 28, 2), packed), who);
    if (!names.insert(name).second) member.refuse("twice in the archive");
    member.require((all += packed) <= zip.all().size() && size / largest_expansion <= packed && packed <= UINT32_MAX);
    if (flags % 2 != 0 || (method != 0 && method != 8)) member.refuse("expected numpy.savez or numpy.savez_compressed");
    const std::string bytes = method == 0 ? std::string(member.all()) : inflated(member, size);
    member.require(bytes.size() == size && crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), size) == crc);
    arrays.push_back(parse_array(Bytes(bytes, who), std::move(name)));
  }
  return arrays;
}

}  // namespace zwang
