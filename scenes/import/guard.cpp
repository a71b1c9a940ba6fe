#include "scenes/import/guard.h"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <new>

#include "scenes/error.h"
#include "scenes/log.h"

namespace penumbra {
namespace {

struct Record {  // before the bytes of each, which are padded so that all are aligned to 16 bytes
  std::uint64_t kind, size;
};
static_assert(sizeof(Record) == 16);

std::size_t padded(std::size_t size) {
  return (size + 15) / 16 * 16;
}

void write_all(int file, const void* from, std::size_t size) {
  const auto* bytes = static_cast<const char*>(from);
  while (size > 0) {
    const ssize_t written = ::write(file, bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw std::bad_alloc();  // a memory file fails for want of memory alone
    bytes += written, size -= std::size_t(written);
  }
}

class File {
 public:
  explicit File(int descriptor) : descriptor_(descriptor) {}
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

void limit(__rlimit_resource resource, rlim_t most) {
  rlimit now = {};
  if (getrlimit(resource, &now) != 0 || now.rlim_cur <= most) return;
  now.rlim_cur = most;
  setrlimit(resource, &now);
}

/// Bytes of writable memory that this process has mapped.
rlim_t data_in_use() {
  unsigned long pages[6] = {};
  if (std::FILE* status = std::fopen("/proc/self/statm", "r")) {
    for (unsigned long& n : pages)
      if (std::fscanf(status, "%lu", &n) != 1) n = 0;
    std::fclose(status);
  }
  return rlim_t(pages[5]) * rlim_t(sysconf(_SC_PAGESIZE));
}

/// The child dies by the default action of its signals, silently, with its parent, and when its time is up.
void prepare_child(double seconds, std::size_t bytes) {
  for (const int signal : {SIGINT, SIGTERM, SIGALRM, SIGABRT}) std::signal(signal, SIG_DFL);
  if (!sanitized)
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL}) std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  limit(RLIMIT_CORE, 0);
  if (!sanitized) limit(RLIMIT_DATA, data_in_use() + (rlim_t(4) << 30) + rlim_t(200) * bytes);
  itimerval timer = {};
  timer.it_value.tv_sec = time_t(seconds);
  timer.it_value.tv_usec = suseconds_t(1e6 * (seconds - double(timer.it_value.tv_sec)));
  setitimer(ITIMER_REAL, &timer, nullptr);
}

[[noreturn]] void run_child(int file, const std::string& path, const std::string& mend,
                            const std::function<void(Outbox&)>& read) {
  Outbox out(file);
  std::string failure;
  try {
    read(out);
    out.write(Outbox::end, nullptr, 0);
    _exit(0);
  } catch (const Error& e) {
    failure = e.what();
  } catch (const std::bad_alloc&) {
    failure = fmt::format("{}: reading it takes more memory than there is; {}", path, mend);
  } catch (const std::exception& e) {
    failure = fmt::format("{}: the importer failed ({}); {}", path, e.what(), mend);
  } catch (...) {
    failure = fmt::format("{}: the importer failed; {}", path, mend);
  }
  try {
    out.write(Outbox::failure, failure.data(), failure.size());
  } catch (...) {
    _exit(2);
  }
  _exit(0);
}

int wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return 0;  // somebody else waits for children: what the child wrote tells how it ended
  return status;
}

std::string cause(int status, double seconds) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) return fmt::format("did not end within {:g} s", seconds);
  if (WIFSIGNALED(status)) return fmt::format("crashed (signal {}, {})", WTERMSIG(status), strsignal(WTERMSIG(status)));
  return fmt::format("crashed (exit code {})", WIFEXITED(status) ? WEXITSTATUS(status) : 0);
}

}  // namespace

void Outbox::write(Kind kind, const void* bytes, std::size_t size) {
  const Record record{kind, size};
  const char zeros[16] = {};
  write_all(file_, &record, sizeof record);
  write_all(file_, bytes, size);
  write_all(file_, zeros, padded(size) - size);
}

Inbox::~Inbox() {
  if (mapping_) munmap(mapping_, size_);
}

std::span<const std::byte> Inbox::next() {
  if (next_ >= arrays_.size()) throw std::logic_error("more arrays taken than were put");
  return arrays_[next_++];
}

double time_limit(std::size_t bytes) {
  return 60.0 + 1e-5 * double(bytes);
}

Inbox guarded(const std::string& path, const std::string& mend, const std::function<void(Outbox&)>& read,
              double seconds) {
  std::error_code ignored;
  const auto found = std::filesystem::file_size(path, ignored);
  const std::size_t bytes = ignored ? 0 : found;
  if (seconds <= 0.0) seconds = time_limit(bytes);

  const File file(memfd_create("penumbra", MFD_CLOEXEC));
  if (file.get() < 0) throw Error("{}: no memory file to read it into ({})", path, std::strerror(errno));
  std::fflush(stdout);  // else the child could write what waits in the buffer a second time
  const pid_t child = fork();
  if (child < 0) throw Error("{}: no process to read it in ({}); end other programs", path, std::strerror(errno));
  if (child == 0) {
    prepare_child(seconds, bytes);
    run_child(file.get(), path, mend, read);
  }
  const int status = wait_for(child);

  struct stat size = {};
  Inbox box;
  if (fstat(file.get(), &size) == 0 && size.st_size > 0) {
    box.size_ = std::size_t(size.st_size);
    void* mapping = mmap(nullptr, box.size_, PROT_READ, MAP_PRIVATE, file.get(), 0);
    if (mapping == MAP_FAILED) throw Error("{}: cannot be mapped ({})", path, std::strerror(errno));
    box.mapping_ = mapping;
  }
  const auto* at = static_cast<const std::byte*>(box.mapping_);
  for (std::size_t left = box.size_; left >= sizeof(Record);) {
    Record record;
    std::memcpy(&record, at, sizeof record);
    at += sizeof record, left -= sizeof record;
    if (record.size > left) break;
    const std::string_view text(reinterpret_cast<const char*>(at), record.size);
    switch (record.kind) {
      case Outbox::data:
        box.arrays_.emplace_back(at, record.size);
        break;
      case Outbox::warning:
        warn("{}", text);
        break;
      case Outbox::information:
        inform("{}", text);
        break;
      case Outbox::failure:
        throw Error("{}", text);
      case Outbox::end:
        return box;
      default:
        left = 0;
        continue;
    }
    const std::size_t step = std::min(padded(record.size), left);
    at += step, left -= step;
  }
  throw Error("{}: the importer {}: the file is damaged, or of a kind that its reader does not understand; {}", path,
              cause(status, seconds), mend);
}

}  // namespace penumbra
