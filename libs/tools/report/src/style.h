// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace headway::report {

/// Style sheet of the page: responsive, light or dark as configured in the reader's system.
inline constexpr char kStyle[] = R"css(
:root{color-scheme:light dark;--ground:#f6f7f9;--card:#fff;--text:#1b2230;--dim:#5d6879;--line:#dfe4ea;
--robot:#c98a00;--truth:#1b2230;--dots:#9aa7b8;--accent:#2f7de1;--pale:#bcd6f7;--warn:#fff1d6;--warntext:#7a4b00}
@media(prefers-color-scheme:dark){:root{--ground:#0f131b;--card:#171d28;--text:#e6eaf0;--dim:#93a0b3;--line:#2a3342;
--robot:#ffd147;--truth:#f0f0f0;--dots:#4c5d75;--accent:#5aa2ff;--pale:#2b4a73;--warn:#3a2c10;--warntext:#ffd98a}}
*{box-sizing:border-box}
body{margin:0;background:var(--ground);color:var(--text);font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif}
main{max-width:1180px;margin:0 auto;padding:24px 20px 64px}
header p{color:var(--dim);margin:0 0 8px;overflow-wrap:anywhere}
h1{font-size:1.9rem;line-height:1.2;margin:8px 0 4px;overflow-wrap:anywhere}
h2{font-size:1.25rem;margin:0 0 12px}h3{font-size:1rem;margin:18px 0 6px}
section{background:var(--card);border:1px solid var(--line);border-radius:12px;padding:20px;margin:18px 0}
.lead,.note{color:var(--dim);margin:-6px 0 14px}.note{margin:10px 0 0}
header .warning{background:var(--warn);color:var(--warntext);border-radius:8px;padding:10px 14px;margin:12px 0}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(165px,1fr));gap:12px;margin:18px 0}
.tile{background:var(--card);border:1px solid var(--line);border-radius:12px;padding:14px 16px;display:flex;flex-direction:column}
.tile b{font-size:1.55rem;line-height:1.25;font-weight:650}.tile i{font-style:normal;font-weight:400;font-size:.9rem;color:var(--dim)}
.tile span{color:var(--dim);font-size:.85rem}.tile .name{font-size:.8rem}
svg{display:block;width:100%}
.map{height:auto;border-radius:8px;background:var(--ground)}
.grid{image-rendering:pixelated}
.dots{stroke:var(--dots);stroke-width:2.4;stroke-linecap:round;fill:none}
.robot,.truth,.track,.truthtrack{fill:none;stroke-linejoin:round;stroke-linecap:round}
.track{stroke-width:3;stroke-opacity:.85}.truthtrack{stroke:var(--truth);stroke-width:1.4;stroke-opacity:.5;stroke-dasharray:3 5}
.robot{stroke:var(--robot);stroke-width:4.5}.truth{stroke:var(--truth);stroke-width:2;stroke-dasharray:7 7}
.start{fill:var(--ground);stroke:var(--robot);stroke-width:4}
.bar{stroke:var(--text);stroke-width:5}.bartext{fill:var(--text);font-size:26px}
.legend{display:flex;flex-wrap:wrap;gap:4px 18px;margin:12px 0 0;font-size:.9rem}
.swatch{display:inline-block;width:16px;height:6px;border-radius:3px;margin-right:7px;vertical-align:middle}
.robotswatch{background:var(--robot)}.truthswatch{background:var(--truth)}
.pictures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,480px),1fr));gap:14px}
figure{margin:0}.pictures figure:first-child:nth-last-child(odd){grid-column:1/-1}img{width:100%;height:auto;border-radius:8px;display:block}
figcaption{color:var(--dim);font-size:.85rem;margin:5px 0 0}
.plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,420px),1fr));gap:20px;margin:0 0 20px}
.area svg{height:90px;border-bottom:1px solid var(--line)}.area figcaption{margin:0 0 6px}
.fill{fill:var(--pale);opacity:.55}.curve{fill:none;stroke:var(--accent);stroke-width:2;vector-effect:non-scaling-stroke}
.ticks{display:flex;justify-content:space-between;color:var(--dim);font-size:.8rem}
.row{display:grid;grid-template-columns:118px 1fr;gap:12px;align-items:center}
.row .name{font-size:.8rem;color:var(--dim);text-align:right;white-space:nowrap;overflow:hidden;text-overflow:ellipsis}
.timeline svg{height:12px;background:linear-gradient(var(--line),var(--line)) center/100% 1px no-repeat}
.timeline .row{min-height:18px}
.timings .row{grid-template-columns:118px 1fr 118px;margin:7px 0}.timings .name{font-size:.9rem;color:var(--text)}
.stage{height:18px}.p95{fill:var(--pale)}.median{fill:var(--accent)}
.figures{font-size:.85rem;color:var(--dim);white-space:nowrap;font-variant-numeric:tabular-nums}
.scroll{overflow-x:auto}table{border-collapse:collapse;width:100%;font-size:.93rem}
th,td{text-align:left;padding:6px 14px 6px 0;border-bottom:1px solid var(--line);vertical-align:top;font-weight:400}
td:nth-child(2){white-space:nowrap;font-variant-numeric:tabular-nums;font-weight:600}td:nth-child(3){color:var(--dim);width:60%}
tr:last-child>*{border-bottom:0}
details{border-top:1px solid var(--line);padding:8px 0}summary{cursor:pointer}details td:nth-child(2){white-space:normal;overflow-wrap:anywhere}
footer{color:var(--dim);font-size:.85rem;margin-top:26px}
@media(max-width:560px){main{padding:14px 12px 40px}section{padding:14px}.row{grid-template-columns:84px 1fr;gap:8px}
.timings .row{grid-template-columns:84px 1fr}.timings .figures{grid-column:2;margin-top:-4px}
.row .name{font-size:.72rem}.tiles{grid-template-columns:1fr 1fr;gap:8px}.tile{padding:10px 12px}.tile b{font-size:1.2rem}
td:nth-child(3){width:auto}.bartext{font-size:38px}.robot{stroke-width:7}.track{stroke-width:5}.dots{stroke-width:3.4}.start{stroke-width:7}}
)css";

}  // namespace headway::report
