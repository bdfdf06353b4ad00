#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace zwang::hdf5 {

class Handle;

// A group of an open HDF5 file. Whatever goes wrong is a BadFile whose one line names the file, the place in it and
// what was expected. Sizes are checked against the file's before memory is taken, so that a damaged file cannot ask for
// more than it could hold. A dataset that was declared but never written counts as absent. Not for use by two threads.
class Group {
 public:
  // The root group, for reading. A child process reads the whole file first (isolated.h): HDF5 1.10 crashes on some
  // damaged files.
  static Group open(const std::filesystem::path& file);
  // The root group of a new file. One that grows while it is written stays readable at every moment, also when its
  // writer is killed (HDF5's single writer, multiple readers), once all its datasets are there and start_growing() was
  // called. `name`: what messages call the file, where it is not its own name.
  static Group create(const std::filesystem::path& file, bool growing = false, const std::string& name = "");
  void start_growing();

  bool has_group(const std::string& name) const;
  bool has_data(const std::string& name) const;
  Group group(const std::string& name) const;
  std::vector<std::string> groups() const;  // names of the groups inside, numbers in their natural order
  std::vector<std::string> links() const;   // names of all that is inside
  std::vector<std::string> attributes() const;
  bool holds_text(const std::string& dataset) const;  // or attribute
  std::vector<std::size_t> shape(const std::string& dataset) const;

  // The numbers of a dataset (row by row), or else of the group's attribute of that name, converted to T: double,
  // std::int64_t, std::uint64_t. BadFile unless there are as many as expected.
  static constexpr std::size_t any = ~std::size_t{0};
  template <class T>
  std::vector<T> read(const std::string& dataset, std::size_t expected = any) const;
  template <class T>
  T read_one(const std::string& dataset) const {
    return read<T>(dataset, 1).front();
  }
  std::vector<std::string> read_strings(const std::string& dataset) const;

  Group add_group(const std::string& name);
  // T: a number of 8 or 4 bytes, or std::uint8_t.
  template <class T>
  void write(const std::string& dataset, std::span<const T> values);
  template <class T>
  void write_one(const std::string& dataset, T value) {
    write(dataset, std::span<const T>(&value, 1));
  }
  void write_strings(const std::string& dataset, std::span<const std::string> texts);
  void flush();

  // Datasets that grow by rows, in chunks, for files that grow. Numbers are doubles in memory and of this type on disk.
  // `row`: the shape of a row; {}: one number.
  enum class Stored { real, single, integer, flag };  // f64, f32, i32, u8
  void add_rows(const std::string& dataset, Stored type, const std::vector<std::size_t>& row);
  void append_rows(const std::string& dataset, std::span<const double> values);
  std::vector<double> read_rows(const std::string& dataset, std::size_t first, std::size_t count) const;
  // Text beside a dataset, such as its unit.
  void write_attribute(const std::string& dataset, const std::string& name, const std::string& text);

  // Throws BadFile("FILE: PLACE: what").
  [[noreturn]] void fail(const std::string& name, const std::string& what) const;

 private:
  struct File;
  struct Dataset;
  static Group open_here(const std::filesystem::path& file);
  void rehearse(int depth) const;  // reads all that is inside, so many groups deep
  Group(std::shared_ptr<const File> file, std::shared_ptr<const Handle> id, std::string path)
      : file_(std::move(file)), id_(std::move(id)), path_(std::move(path)) {}
  std::string path_to(const std::string& name) const;
  void require_written(bool done, const std::string& name = {}) const;
  void write_raw(const std::string& name, std::int64_t disk, std::int64_t memory, std::size_t n, const void* data);

  std::shared_ptr<const File> file_;
  std::shared_ptr<const Handle> id_;
  std::string path_;
};

}  // namespace zwang::hdf5
