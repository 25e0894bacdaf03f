// The words of a pixel's splats (core/kernel/splat.h).
#ifndef LAMPYRIS_KERNEL_SPLAT_LAYOUT
#define LAMPYRIS_KERNEL_SPLAT_LAYOUT

CONST uint SPLAT_NUMBER_WORDS = 4u;  // of each of a colour's three numbers
CONST uint SPLAT_LOST = 12u;         // word that counts the splats which are not finite, or beyond SPLAT_LARGEST quanta
CONST uint SPLAT_WORDS = 13u;
CONST float SPLAT_LARGEST = 3.9614081257132169e28f;  // 2^95: as many of these as a word counts do not overflow

#endif
