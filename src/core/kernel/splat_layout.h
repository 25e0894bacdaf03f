// The words of a pixel's splats (core/kernel/splat.h).
#ifndef LAMPYRIS_KERNEL_SPLAT_LAYOUT
#define LAMPYRIS_KERNEL_SPLAT_LAYOUT

CONST uint SPLAT_LOST = 6u;  // word that counts the splats which are not finite, or beyond SPLAT_LARGEST quanta
CONST uint SPLAT_WORDS = 7u;
CONST float SPLAT_LARGEST = 7.2057594037927936e16f;  // 2^56: 127 of these in one pixel and pass do not overflow

#endif
