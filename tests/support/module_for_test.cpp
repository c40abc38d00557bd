/// The module that tests/core/module_test.cpp loads.
extern "C" [[gnu::visibility("default")]] int motorcade_for_test(int value) { return value + 1; }
