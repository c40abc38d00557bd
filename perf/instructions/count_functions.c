// Plugin of qemu's user emulation that counts the guest instructions within functions of a program, with all that they call. A function is
// entered at its first address, and left by a return in its range; functions that are counted do not call each other.
//   qemu-ARCH -plugin libcount_functions.so,of=NAME:FIRST:END,of=...,to=FILE PROGRAM
// writes a line "NAME CALLS INSTRUCTIONS" for each function, and one for all of the program. Addresses are hexadecimal.
#include <inttypes.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The part of qemu's plugin interface, version 1 (docs/devel/tcg-plugins), that is used here.
struct qemu_plugin_tb;
struct qemu_plugin_insn;
typedef uint64_t qemu_plugin_id_t;
typedef void (*BlockTranslated)(qemu_plugin_id_t id, struct qemu_plugin_tb* block);
typedef void (*BlockRuns)(unsigned thread, void* data);
typedef void (*ProgramEnds)(qemu_plugin_id_t id, void* data);
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t id, BlockTranslated call);
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb* block, BlockRuns call, int flags, void* data);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t id, ProgramEnds call, void* data);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb* block);
uint64_t qemu_plugin_tb_vaddr(const struct qemu_plugin_tb* block);
struct qemu_plugin_insn* qemu_plugin_tb_get_insn(const struct qemu_plugin_tb* block, size_t index);
const void* qemu_plugin_insn_data(const struct qemu_plugin_insn* instruction);
size_t qemu_plugin_insn_size(const struct qemu_plugin_insn* instruction);
uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn* instruction);

__attribute__((visibility("default"))) int qemu_plugin_version = 1;

enum { kMostFunctions = 32, kMostThreads = 64 };

struct Function {
  char name[64];
  uint64_t first, end;
};
static struct Function functions[kMostFunctions];
static int function_count;
static char result_file[4096];

// A thread is in one function, or in none of them: in the one after the last.
static struct Thread {
  int in;
  uint64_t calls[kMostFunctions + 1], instructions[kMostFunctions + 1];
} threads[kMostThreads];

struct Block {
  size_t instructions;
  int enters;   // a function, or -1
  bool leaves;  // whichever function it is in
};

static bool returns(const struct qemu_plugin_insn* instruction) {
  static const unsigned char kArm64[] = {0xc0, 0x03, 0x5f, 0xd6};
  const unsigned char* bytes = qemu_plugin_insn_data(instruction);
  const size_t size = qemu_plugin_insn_size(instruction);
  if (size == 4 && memcmp(bytes, kArm64, 4) == 0) return true;
  return (size == 1 && bytes[0] == 0xc3) || (size == 2 && (bytes[0] == 0xf3 || bytes[0] == 0xf2) && bytes[1] == 0xc3);
}

static void run(unsigned thread, void* data) {
  const struct Block* block = data;
  struct Thread* state = &threads[thread % kMostThreads];
  if (block->enters >= 0) {
    state->in = block->enters + 1;
    ++state->calls[state->in];
  }
  state->instructions[state->in] += block->instructions;
  if (block->leaves) state->in = 0;
}

static void translate(qemu_plugin_id_t id, struct qemu_plugin_tb* translated) {
  (void)id;
  struct Block* block = malloc(sizeof *block);  // lives as long as the program
  block->instructions = qemu_plugin_tb_n_insns(translated);
  block->enters = -1;
  block->leaves = false;
  const struct qemu_plugin_insn* last = qemu_plugin_tb_get_insn(translated, block->instructions - 1);
  for (int i = 0; i < function_count; ++i) {
    if (qemu_plugin_tb_vaddr(translated) == functions[i].first) block->enters = i;
    const uint64_t at = qemu_plugin_insn_vaddr(last);
    if (at >= functions[i].first && at < functions[i].end && returns(last)) block->leaves = true;
  }
  qemu_plugin_register_vcpu_tb_exec_cb(translated, run, 0, block);
}

static void report(qemu_plugin_id_t id, void* data) {
  (void)id, (void)data;
  FILE* file = fopen(result_file, "w");
  if (!file) return;
  uint64_t all = 0;
  for (int i = 0; i <= function_count; ++i) {
    uint64_t calls = 0, instructions = 0;
    for (int thread = 0; thread < kMostThreads; ++thread)
      calls += threads[thread].calls[i], instructions += threads[thread].instructions[i];
    all += instructions;
    if (i > 0) fprintf(file, "%s %" PRIu64 " %" PRIu64 "\n", functions[i - 1].name, calls, instructions);
  }
  fprintf(file, "all 1 %" PRIu64 "\n", all);
  fclose(file);
}

__attribute__((visibility("default"))) int qemu_plugin_install(qemu_plugin_id_t id, const void* machine, int count, char** arguments) {
  (void)machine;
  for (int i = 0; i < count; ++i) {
    struct Function* function = &functions[function_count];
    if (sscanf(arguments[i], "to=%4095s", result_file) == 1) continue;
    if (function_count == kMostFunctions ||
        sscanf(arguments[i], "of=%63[^:]:%" SCNx64 ":%" SCNx64, function->name, &function->first, &function->end) != 3) {
      fprintf(stderr, "count_functions: %s is no function, or one too many\n", arguments[i]);
      return 1;
    }
    ++function_count;
  }
  qemu_plugin_register_vcpu_tb_trans_cb(id, translate);
  qemu_plugin_register_atexit_cb(id, report, NULL);
  return 0;
}
