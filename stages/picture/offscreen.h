// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pneuma::stages::picture {

// An OpenGL context without a window or a screen, current while it lives. Needs EGL with surfaceless contexts (Mesa has
// them, in software too). Throws Error with what to install where there is none.
class OffscreenContext {
public:
  OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;
  ~OffscreenContext();

private:
  void* display_ = nullptr;
  void* context_ = nullptr;
};

} // namespace pneuma::stages::picture
