// SPDX-License-Identifier: BSD-3-Clause
// What differs between the supported versions of MRPT.
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
/// HEADWAY_MRPT_DEPTH_PIXELS: format and type of its depths, whose 24 bits are the upper ones of
/// 32; the newer one has no stencil.
#if MRPT_VERSION >= 0x270
using MrptFramebuffer = mrpt::opengl::FrameBuffer;
#define HEADWAY_MRPT_FRAMEBUFFER <mrpt/opengl/FrameBuffer.h>
#define HEADWAY_MRPT_DEPTH_PIXELS GL_DEPTH_COMPONENT, GL_UNSIGNED_INT
#else
using MrptFramebuffer = mrpt::opengl::COpenGLFramebuffer;
#define HEADWAY_MRPT_FRAMEBUFFER <mrpt/opengl/COpenGLFramebuffer.h>
#define HEADWAY_MRPT_DEPTH_PIXELS GL_DEPTH_STENCIL, GL_UNSIGNED_INT_24_8
#endif

/// What a map class's internal_CreateFromMapDefinition() returns, made from a pointer whose
/// ownership is passed on.
#if MRPT_VERSION >= 0x20b03
using MrptCreatedMap = std::shared_ptr<mrpt::maps::CMetricMap>;
#else
using MrptCreatedMap = mrpt::maps::CMetricMap*;
#endif

/// What follows seven numbers, one for each factor by which mrpt::nav::CHolonomicFullEval can weigh
/// a direction. The eighth, the heading at the target, is not used.
#if MRPT_VERSION >= 0x20e03
#define HEADWAY_MRPT_EIGHTH_FACTOR ", 0"
#else
#define HEADWAY_MRPT_EIGHTH_FACTOR ""
#endif

}  // namespace headway
