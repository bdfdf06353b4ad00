#include <zwang/core/files/stored_file.h>

#include <openssl/evp.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <stdexcept>

namespace zwang {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& why) { throw BadFile(file.string() + ": " + why); }

std::string lower_extension(const fs::path& file) {
  std::string text = file.extension().string();
  for (char& ch : text)
    if (ch >= 'A' && ch <= 'Z') ch = static_cast<char>(ch - 'A' + 'a');
  return text;
}

}  // namespace

bool StoredFile::packed() const { return lower_extension(path) == ".gz"; }

std::string StoredFile::kind() const { return lower_extension(packed() ? path.stem() : path); }

StoredFile read_stored(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) refuse(file, error ? error.message() : "no such file");
  if (fs::is_directory(file, error)) refuse(file, "a folder, not a file");
  if (!fs::is_regular_file(file, error)) refuse(file, "a pipe or device, not a file");
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) refuse(file, "not readable");
  std::string bytes(static_cast<std::size_t>(in.tellg()), '\0');
  in.seekg(0);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) refuse(file, "cannot be read to its end");
  if (bytes.empty()) refuse(file, "0 bytes");
  return {file, std::move(bytes)};
}

void replace_file(const fs::path& file, std::string_view bytes) {
  const fs::path beside = file.string() + "." + std::to_string(getpid());
  std::ofstream out(beside, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  std::error_code error;
  if (out) fs::rename(beside, file, error);
  if (out && !error) return;
  fs::remove(beside, error);
  refuse(file, "cannot be written; expected a writable place with room");
}

// A gzip file may hold several members one behind the other, which are one file.
std::string unpacked(const StoredFile& file, std::size_t most) {
  if (!file.packed()) return file.bytes;
  z_stream stream = {};
  if (inflateInit2(&stream, 15 + 16) != Z_OK) refuse(file.path, "zlib cannot start");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  constexpr std::size_t longest = std::size_t{1} << 30;  // that zlib is given at once
  std::string out;
  std::size_t read = 0;
  for (int status = Z_OK; status != Z_STREAM_END || read < file.bytes.size();) {
    if (status == Z_STREAM_END) inflateReset(&stream);
    const std::size_t have = out.size();
    if (have > most) refuse(file.path, "unpacks to more than " + std::to_string(most >> 20) + " MB");
    out.resize(std::max(2 * have, 4 * file.bytes.size() + 4096));
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(file.bytes.data())) + read;
    stream.avail_in = static_cast<uInt>(std::min(file.bytes.size() - read, longest));
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + have);
    stream.avail_out = static_cast<uInt>(std::min(out.size() - have, longest));
    const uInt given_in = stream.avail_in, given_out = stream.avail_out;
    status = inflate(&stream, Z_NO_FLUSH);
    read += given_in - stream.avail_in;
    out.resize(have + (given_out - stream.avail_out));
    if (status != Z_OK && status != Z_STREAM_END) refuse(file.path, "not a whole gzip file");
  }
  if (out.size() > most) refuse(file.path, "unpacks to more than " + std::to_string(most >> 20) + " MB");
  return out;
}

std::string sha256(std::string_view bytes) {
  std::array<unsigned char, 32> digest;
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1)
    throw std::runtime_error("SHA-256 is not available");
  std::string text;
  for (const unsigned char byte : digest)
    for (const int digit : {byte >> 4, byte & 15}) text += "0123456789abcdef"[digit];
  return text;
}

}  // namespace zwang
