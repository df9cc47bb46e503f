/* SPDX-License-Identifier: MIT
 *
 * Two black unit squares that face each other, one metre apart (facing_squares.gltf). The upper one shines:
 * as stored, with other materials, with an image on it, beside a sky; then a lamp does, behind a mask. What
 * arrives in the middle of the lower one, at the only sensor, is known in closed form. */
#ifndef CONSUMER_COLORS_H
#define CONSUMER_COLORS_H

#include "device.h"

/* 0 when all is as it should be. */
int check_colors(struct renderer* renderer, const relume_model* model);

#endif
