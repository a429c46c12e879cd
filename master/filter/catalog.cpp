#include "master/filter/catalog.h"

#include <array>

#include "master/filter/bilateral.h"
#include "master/filter/eaw.h"
#include "master/filter/fdf.h"
#include "master/filter/gauss.h"
#include "master/filter/guided.h"
#include "master/filter/nfor.h"
#include "master/filter/nlm.h"
#include "master/filter/none.h"
#include "master/filter/oidn.h"
#include "master/filter/pixel.h"
#include "master/filter/psvgf.h"
#include "master/filter/statmc.h"

namespace tessera::filter {

std::span<const FilterEntry> catalog() {
    static const std::array Table{
        none_entry(), pixel_entry(), fdf_entry(),    psvgf_entry(),  gauss_entry(), bilateral_entry(),
        eaw_entry(),  nlm_entry(),   guided_entry(), statmc_entry(), nfor_entry(),  oidn_entry(),
    };
    return Table;
}

}  // namespace tessera::filter
