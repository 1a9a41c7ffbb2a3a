// What the program's allocator, jemalloc, is to do; MALLOC_CONF in the environment overrides it. Meshing is arrays of hundreds of
// megabytes, each written once and read a few times. In pages of 4 kB the first touch of each page, which goes to the
// operating system (or, on a virtual machine, beyond), takes up to a third of the whole run. So huge pages are asked for
// where the system leaves that to the program (madvise). Freed memory goes back within a second, so that the next
// stage has it.
extern "C" {
extern const char* malloc_conf;
const char* malloc_conf = "thp:always,dirty_decay_ms:1000,muzzy_decay_ms:0";
}
