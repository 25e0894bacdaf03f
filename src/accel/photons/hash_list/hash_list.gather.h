// Chains are traversed in the same way as those that were linked in parallel.
#include "accel/photons/linked_list/linked_list.gather.h"
