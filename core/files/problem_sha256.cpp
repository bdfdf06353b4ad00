#include <openssl/evp.h>

#include <bit>
#include <memory>
#include <stdexcept>

#include <zwang/core/files/problem_file.h>

namespace zwang {
namespace {

// Feeds numbers to the digest as little-endian 64-bit words.
class Digest {
 public:
  Digest() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    check(EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr));
  }

  void add(std::uint64_t word) {
    unsigned char bytes[8];
    for (int k = 0; k < 8; ++k) bytes[k] = static_cast<unsigned char>(word >> (8 * k));
    check(EVP_DigestUpdate(context_.get(), bytes, sizeof bytes));
  }
  void add(Index number) { add(static_cast<std::uint64_t>(number)); }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  void add(const Vector& v) {
    for (const double x : v) add(x);
  }
  // Entries that are not zero, so that the stored pattern does not matter.
  template <int Options>
  void add(const Eigen::SparseMatrix<double, Options>& A) {
    for (Index k = 0; k < A.outerSize(); ++k)
      for (typename Eigen::SparseMatrix<double, Options>::InnerIterator it(A, k); it; ++it)
        if (it.value() != 0) {
          add(Index{it.row()});
          add(Index{it.col()});
          add(it.value());
        }
    add(Index{-1});
  }

  std::string hexadecimal() {
    unsigned char bytes[32];
    unsigned int size = 0;
    check(EVP_DigestFinal_ex(context_.get(), bytes, &size));
    std::string text;
    for (const unsigned char byte : bytes) {
      text += "0123456789abcdef"[byte >> 4];
      text += "0123456789abcdef"[byte & 15];
    }
    return text;
  }

 private:
  static void check(int ok) {
    if (ok != 1) throw std::runtime_error("SHA-256 is not available in this OpenSSL");
  }
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::string problem_sha256(const Problem& p) {
  Digest digest;
  digest.add(p.size());
  digest.add(p.rows());
  digest.add(p.M);
  digest.add(p.J);
  digest.add(p.z_u);
  digest.add(p.c);
  for (const RowKind kind : p.kind) digest.add(static_cast<std::uint64_t>(kind));
  return digest.hexadecimal();
}

}  // namespace zwang
