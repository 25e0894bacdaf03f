// A kernel's entry point on Vulkan: backends/shaders/shader_compiler.cpp appends it to every shader.
layout(local_size_x = KERNEL_LOCAL_SIZE) in;
layout(push_constant) uniform KernelRange { uint begin; uint count; } kernel_range;

void main() {
    uint place = gl_GlobalInvocationID.x;
    if (place >= kernel_range.count) return;
#ifdef LAMPYRIS_KERNEL_SCENE
    invocation_begin();
#endif
    kernel_main(kernel_range.begin + place);
#ifdef LAMPYRIS_KERNEL_SCENE
    invocation_end();
#endif
}
