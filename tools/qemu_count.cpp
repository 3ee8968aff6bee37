/// A plugin of qemu-user (7.2 or later) that counts the instructions a program executes, by function.
/// count_instructions.py compiles and runs it. Debian ships no header of qemu's plugin interface: what is used of its
/// version 1 is declared here.
///
///     qemu-aarch64 -d plugin -D /dev/null -plugin qemu_count.so,out=FILE PROGRAM ...
///
/// FILE gets a line per function, "COUNT SYMBOL"; "?" stands for what has no symbol (the shared libraries). qemu knows
/// the symbols only while it logs something, hence -d.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <map>
#include <mutex>
#include <string>

extern "C" {
struct qemu_plugin_tb;
struct qemu_plugin_insn;
struct qemu_info_t;
using qemu_plugin_id_t = std::uint64_t;
std::size_t qemu_plugin_tb_n_insns(const qemu_plugin_tb* block);
qemu_plugin_insn* qemu_plugin_tb_get_insn(const qemu_plugin_tb* block, std::size_t index);
const char* qemu_plugin_insn_symbol(const qemu_plugin_insn* instruction);
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t id, void (*call)(qemu_plugin_id_t, qemu_plugin_tb*));
void qemu_plugin_register_vcpu_tb_exec_inline(qemu_plugin_tb* block, int operation, void* counter, std::uint64_t add);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t id, void (*call)(qemu_plugin_id_t, void*), void* data);

__attribute__((visibility("default"))) int qemu_plugin_version = 1;
__attribute__((visibility("default"))) int qemu_plugin_install(qemu_plugin_id_t id, const qemu_info_t* about, int count,
                                                               char** words);
}

namespace {

constexpr int kAddToCounter = 0;  // QEMU_PLUGIN_INLINE_ADD_U64

std::mutex guard;  // translations may come from several threads
std::map<std::string, std::uint64_t> executed;
std::string out;

/// A block of code belongs to the function of its first instruction. Its counter is raised whenever it runs.
void translated(qemu_plugin_id_t, qemu_plugin_tb* block) {
  const char* symbol = qemu_plugin_insn_symbol(qemu_plugin_tb_get_insn(block, 0));
  const std::scoped_lock lock(guard);
  qemu_plugin_register_vcpu_tb_exec_inline(block, kAddToCounter, &executed[symbol && *symbol ? symbol : "?"],
                                           qemu_plugin_tb_n_insns(block));
}

void write_counts(qemu_plugin_id_t, void*) {
  std::FILE* const file = std::fopen(out.c_str(), "w");
  if (!file) return;
  for (const auto& [symbol, count] : executed)
    std::fprintf(file, "%llu %s\n", static_cast<unsigned long long>(count), symbol.c_str());
  std::fclose(file);
}

}  // namespace

int qemu_plugin_install(qemu_plugin_id_t id, const qemu_info_t*, int count, char** words) {
  for (int i = 0; i < count; ++i)
    if (std::strncmp(words[i], "out=", 4) == 0) out = words[i] + 4;
  if (out.empty()) {
    std::fputs("qemu_count: no file to write to; say out=FILE behind the plugin's name\n", stderr);
    return 1;
  }
  qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
  qemu_plugin_register_atexit_cb(id, write_counts, nullptr);
  return 0;
}
