#pragma once
#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

namespace raylab::bvh {

/// Uninitialised memory for plain data, on huge pages where the system gives them: traversal jumps about in more
/// memory than the address caches cover with small pages, and a build touches each page of its arrays once.
template <class T>
class HugeArray {
 public:
  static_assert(std::is_trivially_destructible_v<T>);

  HugeArray() = default;
  explicit HugeArray(std::size_t size) : size_(size) {
    if (size == 0) return;
    constexpr std::size_t huge_page = std::size_t{1} << 21;
    const std::size_t wanted = size * sizeof(T);
    const std::size_t alignment = wanted >= huge_page ? huge_page : 64;
    bytes_ = (wanted + alignment - 1) / alignment * alignment;
    if (alignment == huge_page && wanted % huge_page != 0) {
      // What lies past the last whole huge page would waste most of one.
      bytes_ = (wanted + 4095) / 4096 * 4096;
    }
    void* memory = nullptr;
    if (posix_memalign(&memory, alignment, bytes_) != 0) throw std::bad_alloc();
    data_.reset(static_cast<T*>(memory));
    if (alignment == huge_page) madvise(memory, bytes_ / huge_page * huge_page, MADV_HUGEPAGE);
  }

  T* data() const { return data_.get(); }
  std::size_t size() const { return size_; }
  std::size_t bytes() const { return bytes_; }
  T& operator[](std::size_t i) const { return data_.get()[i]; }
  T* begin() const { return data(); }
  T* end() const { return data() + size_; }
  bool empty() const { return size_ == 0; }
  /// Forgets the elements from the given one on.
  void shrink(std::size_t size) { size_ = size; }

 private:
  struct Free {
    void operator()(T* p) const { std::free(p); }
  };
  std::unique_ptr<T, Free> data_;
  std::size_t size_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace raylab::bvh
