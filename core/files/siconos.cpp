#include <charconv>
#include <cmath>

#include <zwang/core/files/layouts.h>
#include <zwang/core/files/stored_file.h>

namespace zwang {
namespace {

// The numbers of a text file, one after another.
class Words {
 public:
  explicit Words(const std::filesystem::path& file) : path_(file), text_(read_stored(file).bytes) {}

  template <class T>
  T number(const char* what) {
    at_ = text_.find_first_not_of(" \t\r\n", at_);
    if (at_ == std::string::npos) fail(std::string("ends before ") + what);
    const std::size_t end = std::min(text_.find_first_of(" \t\r\n", at_), text_.size());
    ++word_;
    T value{};
    const char* first = text_.data() + at_ + (text_[at_] == '+' ? 1 : 0);
    const auto [stop, error] = std::from_chars(first, text_.data() + end, value);
    if (error != std::errc() || stop != text_.data() + end) fail(std::string("expected ") + what);
    if constexpr (std::is_same_v<T, double>)
      if (!std::isfinite(value)) fail(std::string("not finite; expected ") + what);
    at_ = end;
    return value;
  }
  // Each number takes two characters at least, so a damaged file cannot ask for more than it could hold.
  Index count(const char* what) {
    const auto value = number<std::int64_t>(what);
    if (value < 0 || value > std::ssize(text_)) fail(std::to_string(value) + "; expected " + what);
    return value;
  }
  template <class T>
  std::vector<T> numbers(Index count, const char* what) {
    std::vector<T> all;
    for (Index k = 0; k < count; ++k) all.push_back(number<T>(what));
    return all;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw BadFile(path_.string() + ": word " + std::to_string(word_) + ": " + what);
  }

 private:
  std::filesystem::path path_;
  std::string text_;
  std::size_t at_ = 0, word_ = 0;
};

Vector to_vector(const std::vector<double>& values) {
  return Eigen::Map<const Vector>(values.data(), std::ssize(values));
}

Matrix read_dense(Words& words, Index size) {
  Matrix W(size, size);
  for (Index i = 0; i < size; ++i)
    for (Index j = 0; j < size; ++j) W(i, j) = words.number<double>("an entry of W");
  return W;
}

// Sparse blocks: their count, the cumulative sizes, a compressed-row index, then each block by columns.
Matrix read_blocks(Words& words, Index size) {
  const Index blocks = words.count("the number of blocks"), rows = words.count("rows of blocks"),
              columns = words.count("columns of blocks");
  const auto row_end = words.numbers<std::int64_t>(rows, "a cumulative size"),
             column_end = words.numbers<std::int64_t>(columns, "a cumulative size");
  const Index filled = words.count("the length of index1"), used = words.count("the length of index2");
  const auto first = words.numbers<std::int64_t>(filled, "an entry of index1"),
             column = words.numbers<std::int64_t>(used, "an entry of index2");
  if (used < blocks) words.fail("index2 has " + std::to_string(used) + " entries; expected " + std::to_string(blocks));
  Matrix W = Matrix::Zero(size, size);
  const auto begin_of = [](const std::vector<std::int64_t>& end, std::int64_t k) {
    return k > 0 ? end[static_cast<std::size_t>(k - 1)] : 0;
  };
  for (Index k = 0; k < blocks; ++k) {
    const Index block = words.count("the number of a block");
    const auto at = static_cast<std::size_t>(block);
    std::int64_t row = 0;
    while (row + 2 < filled && first[static_cast<std::size_t>(row + 1)] <= block) ++row;
    if (block >= blocks || column[at] < 0 || column[at] >= columns || row >= rows)
      words.fail("expected the number of a block below " + std::to_string(blocks));
    const std::int64_t top = begin_of(row_end, row), left = begin_of(column_end, column[at]),
                       bottom = row_end[static_cast<std::size_t>(row)],
                       right = column_end[static_cast<std::size_t>(column[at])];
    if (top < 0 || left < 0 || bottom < top || right < left || bottom > size || right > size)
      words.fail("block " + std::to_string(block) + " lies outside of W");
    for (Index j = left; j < right; ++j)
      for (Index i = top; i < bottom; ++i) W(i, j) += words.number<double>("an entry of a block");
  }
  return W;
}

}  // namespace

Instance read_siconos(const std::filesystem::path& file, std::optional<Law> law) {
  Words words(file);
  LocalForm form;
  form.dim = words.count("the dimension, 2 or 3");
  if (form.dim != 2 && form.dim != 3) words.fail("dimension " + std::to_string(form.dim) + "; expected 2 or 3");
  const Index contacts = words.count("the number of contacts"), size = form.dim * contacts;
  const Index storage = words.count("the storage: 0 dense, 1 sparse-block");
  if (storage > 1) words.fail("storage " + std::to_string(storage) + "; expected 0 (dense) or 1 (sparse-block)");
  for (int pass = 0; pass < (storage == 0 ? 2 : 1); ++pass)
    if (words.count("the rows of W") != size || words.count("the columns of W") != size)
      words.fail("W should be " + std::to_string(size) + " x " + std::to_string(size) + ", for " +
                 std::to_string(contacts) + " contacts");
  form.W = storage == 0 ? read_dense(words, size) : read_blocks(words, size);
  form.q = to_vector(words.numbers<double>(size, "an entry of q"));
  form.mu = to_vector(words.numbers<double>(contacts, "a friction coefficient"));
  if (contacts > 0 && form.mu.minCoeff() < 0) words.fail("mu is negative; expected a friction coefficient >= 0");
  if (law == Law::frictionless) form.mu.resize(0);
  return from_local_form(std::move(form), law, [&](const std::string& place, const std::string& what) {
    throw BadFile(file.string() + ": " + place + ": " + what);
  });
}

}  // namespace zwang
