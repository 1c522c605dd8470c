{{%AUTOESCAPE context="HTML"}}
<section class="card">
<h2 id="cameras" data-part="Cameras">Cameras <span class="soft">what their pictures say, corner by corner</span></h2>
{{#TABLE}}
<div class="scroll" tabindex="0" role="region" aria-labelledby="cameras">
<table data-sortable>
<thead><tr><th scope="col" data-column="0">Camera</th><th scope="col" data-column="1">Pictures</th><th scope="col" data-column="2">Corners</th><th scope="col" data-column="3">Residual rms,<br>px</th><th scope="col" data-column="4">Picture<br>covered, %</th><th scope="col" data-column="5">Largest tilt,<br>deg</th><th scope="col" data-column="6">Nearest<br>board, m</th><th scope="col" data-column="7">Farthest<br>board, m</th><th scope="col" data-column="8">fx, px</th><th scope="col" class="sigma" data-column="9">&sigma;, px</th><th scope="col" class="text" data-column="10">Intrinsics</th></tr></thead>
<tbody>
{{#ROW}}<tr><th scope="row"><a href="#{{ANCHOR}}">{{CAMERA}}</a></th><td>{{PICTURES}}</td><td>{{CORNERS}}</td><td>{{RMS}}</td><td>{{COVERED}}</td><td>{{TILT}}</td><td>{{NEAR}}</td><td>{{FAR}}</td><td>{{FX}}</td><td class="sigma">{{FX_SIGMA}}</td><td class="text">{{SOURCE}}</td></tr>
{{/ROW}}
</tbody>
</table>
</div>
{{/TABLE}}
{{#WITHOUT}}<p class="hint">No residuals are kept of <bdi>{{NAMES}}</bdi>: no edge of theirs found the board in a picture, or they were calibrated by a version that did not keep them.</p>{{/WITHOUT}}
</section>
{{#ONE}}
{{>CAMERA_DETAIL}}
{{/ONE}}
