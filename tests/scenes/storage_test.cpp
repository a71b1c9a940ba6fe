#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <future>

#include "scenes/content.h"
#include "scenes/error.h"
#include "scenes/image.h"
#include "scenes/sphere_set.h"
#include "scenes/storage/cache.h"
#include "tests/support.h"

namespace penumbra {
namespace {

std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
  return names;
}

/// Runs in a process of its own, whose exit code is what the call returns, or 99 if it throws.
template <class Call>
pid_t in_a_child(Call call) {
  const pid_t child = fork();
  if (child != 0) return child;
  try {
    _exit(call());
  } catch (...) {
    _exit(99);
  }
}

int exit_code_of(pid_t child) {
  int status = -1;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Texts that differ in length and in every byte.
std::string text_of(int writer, int turn) {
  return std::string(std::size_t(200000 + 1000 * writer + turn), char('a' + writer));
}

bool is_whole(const std::string& text) {
  return !text.empty() && text.find_first_not_of(text[0]) == std::string::npos &&
         int(text.size()) / 1000 == 200 + text[0] - 'a';
}

int write_many(const std::string& path, int writer) {
  for (int turn = 0; turn < 100; ++turn) write_atomically(path, text_of(writer, turn));
  return 0;
}

TEST(AtomicWrite, ThreadsAndProcessesThatWriteOneFileLeaveItWhole) {
  const test::TemporaryFolder folder;
  const std::string path = folder.write("one.txt", text_of(0, 0));
  const pid_t first = in_a_child([&] { return write_many(path, 1); });
  const pid_t second = in_a_child([&] { return write_many(path, 2); });
  auto third = std::async(std::launch::async, write_many, path, 3);
  auto fourth = std::async(std::launch::async, write_many, path, 4);
  for (int look = 0; look < 200; ++look) EXPECT_TRUE(is_whole(test::read_text(path))) << "while it is written";
  EXPECT_EQ(third.get(), 0);
  EXPECT_EQ(fourth.get(), 0);
  EXPECT_EQ(exit_code_of(first), 0);
  EXPECT_EQ(exit_code_of(second), 0);
  EXPECT_TRUE(is_whole(test::read_text(path)));
  EXPECT_EQ(files_in(folder.path()), std::vector<std::string>{"one.txt"});
}

TEST(AtomicWrite, NamesAsLongAsTheFileSystemAllows) {
  const test::TemporaryFolder folder;
  for (const std::size_t size : {250u, 255u})
    for (const std::string extension : {"", ".json", ".png"}) {
      const std::string path = folder.path() + "/" + std::string(size - extension.size(), 'n') + extension;
      if (extension == ".png") save_png(path, test::grey({0.5f}, 1));
      else write_atomically(path, "text");
      EXPECT_GT(std::filesystem::file_size(path), 0u) << path;
    }
  write_atomically(folder.path() + "/." + std::string(254, 'n'), "no extension");
  EXPECT_EQ(files_in(folder.path()).size(), 7u);
}

TEST(AtomicWrite, WhatFailsLeavesTheFileBeforeAndNothingElse) {
  const test::TemporaryFolder folder;
  const std::string path = folder.write("kept.txt", "before");
  EXPECT_EQ(test::error_of([&] {
              write_atomically(path, [](const std::string& temporary) {
                std::ofstream(temporary) << "half";
                throw Error("stopped");
              });
            }),
            "stopped");
  EXPECT_EQ(test::read_text(path), "before");
  EXPECT_EQ(files_in(folder.path()), std::vector<std::string>{"kept.txt"});

  std::filesystem::create_directories(folder.path() + "/kept/full");
  EXPECT_EQ(test::error_of([&] { write_atomically(folder.path() + "/kept", "text"); }),
            folder.path() + "/kept: cannot be written (Is a directory)");
  EXPECT_EQ(test::error_of([&] { write_atomically(path + "/none", "text"); }),
            path + "/none: cannot be written (Not a directory)");
  EXPECT_EQ(test::error_of([&] { make_folder(path + "/none"); }), path + "/none: cannot be made: Not a directory");
  EXPECT_EQ(files_in(folder.path()).size(), 2u);
}

TEST(AtomicWrite, AFullDiskLeavesTheFileBefore) {
  const test::TemporaryFolder folder;
  const std::string path = folder.write("kept.txt", "before");
  const pid_t child = in_a_child([&] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{1000, 1000};
    setrlimit(RLIMIT_FSIZE, &small);
    const std::string error = test::error_of([&] { write_atomically(path, std::string(2000, 'x')); });
    return error == path + ": cannot be written (File too large)" ? 0 : 1;
  });
  EXPECT_EQ(exit_code_of(child), 0);
  EXPECT_EQ(test::read_text(path), "before");
  EXPECT_EQ(files_in(folder.path()), std::vector<std::string>{"kept.txt"});
}

TEST(AtomicWrite, WhatAKilledProcessLeftIsNotTouched) {
  const test::TemporaryFolder folder;
  std::string name;
  write_atomically(folder.path() + "/a", [&](const std::string& temporary) { name = temporary; });
  const std::size_t count = name.rfind('-') + 1;
  const std::string next = name.substr(0, count) + std::to_string(std::stoi(name.substr(count)) + 1);
  std::ofstream(next) << "left over";
  write_atomically(folder.path() + "/a", "text");
  EXPECT_EQ(test::read_text(folder.path() + "/a"), "text");
  EXPECT_EQ(test::read_text(next), "left over");
}

TEST(ContentKey, StaysWhatFilesOnDiskAreNamedBy) {
  ContentHash hash(3);
  hash.add("ab");
  add_vec(hash, vec3(1, 2, 3));
  EXPECT_EQ(hash.digest(), "8F69B4048625183A856CA2CA360FE7C65DCC5012");
  EXPECT_EQ(checksum(std::vector<float>{1, 2}), "7F6E1D7DE3AB2D47658382FC453EA1E6B73E05B1");
  ContentHash text, bytes;
  text.add("ab"), bytes.add(std::vector<char>{'a', 'b'});
  EXPECT_EQ(text.digest(), bytes.digest());
}

/// A cache of sphere sets. What it says is kept.
class Cache : public testing::Test {
 protected:
  Cache() { setenv("PENUMBRA_CACHE", folder_.path().c_str(), 1); }
  ~Cache() override { unsetenv("PENUMBRA_CACHE"); }

  SphereSet get() {
    const auto compute = [&] { return ++computed_, set_; };
    return entry_.get(load_spheres, compute, store_spheres);
  }
  bool same(const SphereSet& other) const { return checksum(other.spheres) == checksum(set_.spheres); }
  void change(const std::string& bytes) const { std::ofstream(entry_.path(), std::ios::binary) << bytes; }

  const test::TemporaryFolder folder_;
  const SphereSet set_{{{vec3(1.0f, -2.0f, 0.125f), 0.3f}, {vec3(0.1f), 7.5f}}};
  std::atomic<int> computed_ = 0;
  std::string said_;
  CacheEntry entry_{"set.json", "test cache", "computing it anew", [&](const std::string& line) { said_ += line; }};
};

TEST_F(Cache, ComputesOnce) {
  EXPECT_FALSE(entry_.exists());
  EXPECT_FALSE(entry_.look_up(load_spheres));
  EXPECT_TRUE(same(get()));
  EXPECT_TRUE(same(get()));
  EXPECT_EQ(computed_, 1);
  EXPECT_TRUE(entry_.exists());
  EXPECT_EQ(said_, "");
}

TEST_F(Cache, AChangedByteIsNoticed) {
  get();
  const std::string good = test::read_text(entry_.path());
  int noticed = 0;
  for (std::size_t at = 0; at < good.size(); ++at)
    for (const int flip : {1, 16}) {
      std::string bad = good;
      bad[at] = char(bad[at] ^ flip);
      change(bad), said_.clear();
      ASSERT_TRUE(same(get())) << bad;
      if (said_.empty()) continue;
      ++noticed;
      ASSERT_TRUE(said_.starts_with("test cache: " + entry_.path() + ": ") && said_.ends_with("; computing it anew"))
          << said_;
      ASSERT_EQ(test::read_text(entry_.path()), good) << "mended";
    }
  EXPECT_EQ(computed_, 1 + noticed);
  EXPECT_GT(noticed, int(good.size()) / 2);
}

TEST_F(Cache, ACutFileIsNoticed) {
  get();
  const std::string good = test::read_text(entry_.path());
  for (std::size_t size = 0; size + 2 < good.size(); ++size) {
    change(good.substr(0, size)), said_.clear();
    ASSERT_TRUE(same(get()));
    ASSERT_NE(said_, "") << size;
  }
}

TEST_F(Cache, FilesFromBeforeThereWereChecksumsAreRead) {
  save_spheres(entry_.path(), set_);
  EXPECT_TRUE(same(get()));
  EXPECT_EQ(computed_, 0);
}

TEST_F(Cache, AFolderThatCannotBeWrittenCostsAWarning) {
  const std::string file = folder_.write("file", "in the way");
  setenv("PENUMBRA_CACHE", (file + "/cache").c_str(), 1);
  EXPECT_TRUE(same(get()));
  EXPECT_EQ(said_, "test cache: " + file + "/cache: cannot be made: Not a directory; going on without");
  setenv("PENUMBRA_CACHE", folder_.path().c_str(), 1);
  std::filesystem::create_directories(entry_.path() + "/full");
  said_.clear();
  EXPECT_TRUE(same(get()));
  EXPECT_NE(said_.find(entry_.path() + ": cannot be written (Is a directory); going on without"), std::string::npos)
      << said_;
}

TEST_F(Cache, ThreadsAndProcessesThatStoreOneKeyLeaveAWholeFile) {
  const auto compute_and_look = [&] {
    for (int turn = 0; turn < 100; ++turn) {
      const std::optional<SphereSet> found = entry_.look_up(load_spheres);
      if (found && !same(*found)) return 1;
      store_spheres(entry_.path(), set_);
    }
    return same(get()) && computed_ == 0 ? 0 : 1;
  };
  const pid_t first = in_a_child(compute_and_look), second = in_a_child(compute_and_look);
  auto third = std::async(std::launch::async, compute_and_look);
  auto fourth = std::async(std::launch::async, compute_and_look);
  EXPECT_EQ(third.get(), 0);
  EXPECT_EQ(fourth.get(), 0);
  EXPECT_EQ(exit_code_of(first), 0);
  EXPECT_EQ(exit_code_of(second), 0);
  EXPECT_TRUE(same(get()));
  EXPECT_EQ(computed_, 0);
  EXPECT_EQ(said_, "");
  EXPECT_EQ(files_in(folder_.path()), std::vector<std::string>{"set.json"});
}

}  // namespace
}  // namespace penumbra
