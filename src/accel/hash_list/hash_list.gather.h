// Chains are walked as those that were linked in parallel.
#include "accel/linked_list/linked_list.gather.h"
