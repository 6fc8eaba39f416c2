// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/picture/offscreen.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/types.h"

namespace pneuma::stages::picture {

namespace {

[[noreturn]] void fail(const char* step) {
  throw base::InputError(
      fmt::format("no picture without a screen on this machine: {} failed (EGL error {:#x}). Install libegl1, "
                  "libegl-mesa0 and libgl1-mesa-dri, or open the state in ParaView",
                  step, static_cast<unsigned>(eglGetError())));
}

} // namespace

OffscreenContext::OffscreenContext() {
  display_ = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display_ == EGL_NO_DISPLAY) fail("finding a display");
  if (eglInitialize(display_, nullptr, nullptr) != EGL_TRUE) fail("initialising EGL");
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) fail("choosing OpenGL");
  constexpr EGLint wanted[] = {
      EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 2, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
  if (context_ == EGL_NO_CONTEXT) fail("making an OpenGL 3.2 context");
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE) fail("using the context");
}

OffscreenContext::~OffscreenContext() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  eglTerminate(display_);
}

} // namespace pneuma::stages::picture
