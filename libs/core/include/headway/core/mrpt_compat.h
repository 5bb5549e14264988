// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/version.h>

#include <memory>

// All that depends on the version of MRPT: 2.5.8 (Debian 12) to 2.14.7 (Debian 13).
//
// MRPT_VERSION has one hexadecimal digit a part up to 2.10.1 (0x258), and two since (0x20e07), so
// it is compared by >= only.

namespace mrpt::maps {
class CMetricMap;
}

namespace mrpt::opengl {
#if MRPT_VERSION >= 0x270
class Scene;
class FrameBuffer;
using COpenGLScene = Scene;
#else
class COpenGLScene;
class COpenGLFramebuffer;
#endif
}  // namespace mrpt::opengl

namespace headway {

/// OpenGL's off-screen framebuffer, complete after `#include HEADWAY_MRPT_FRAMEBUFFER`.
#if MRPT_VERSION >= 0x270
using MrptFramebuffer = mrpt::opengl::FrameBuffer;
#define HEADWAY_MRPT_FRAMEBUFFER <mrpt/opengl/FrameBuffer.h>
#else
using MrptFramebuffer = mrpt::opengl::COpenGLFramebuffer;
#define HEADWAY_MRPT_FRAMEBUFFER <mrpt/opengl/COpenGLFramebuffer.h>
#endif

/// What a map class's internal_CreateFromMapDefinition() returns, made from a pointer whose
/// ownership is passed on.
#if MRPT_VERSION >= 0x20b03
using MrptCreatedMap = std::shared_ptr<mrpt::maps::CMetricMap>;
#else
using MrptCreatedMap = mrpt::maps::CMetricMap*;
#endif

}  // namespace headway
