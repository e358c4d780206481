// A drawing module of the time when its version was counted by hand: it takes any such count.

extern "C" void* lunid_figure_renderer(int version) {
  static int nothing = 0;
  return version > 0 && version < 1000 ? &nothing : nullptr;
}
