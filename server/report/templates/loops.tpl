{{%AUTOESCAPE context="HTML"}}
<section class="card">
<h2 id="loops" data-part="Loops">Loops <span class="soft">how well edges close, the worst first</span></h2>
<p>{{SUMMARY}}</p>
{{#TABLE}}
<div class="scroll" tabindex="0" role="region" aria-labelledby="loops">
<table class="small">
<thead><tr><th scope="col">Loop</th><th scope="col">Translation, mm</th><th scope="col">Rotation, deg</th><th scope="col">T&sup2; (limit)</th><th scope="col" class="text">State</th></tr></thead>
<tbody>
{{#LOOP}}<tr><th scope="row">{{WALK}}</th><td>{{MM}}</td><td>{{DEG}}</td>{{#TEST}}<td><span{{#BEYOND}} class="beyond"{{/BEYOND}}>{{T2}} ({{LIMIT}})</span></td>{{/TEST}}{{#NO_TEST}}<td class="soft">{{WHY}}</td>{{/NO_TEST}}<td class="text">{{#FAILS}}<span class="badge fail">does not close</span>{{/FAILS}}{{#CLOSES}}<span class="badge pass">closes</span>{{/CLOSES}}{{#UNTESTED}}<span class="badge unknown">not tested</span>{{/UNTESTED}}</td></tr>
{{/LOOP}}
</tbody>
</table>
</div>
{{/TABLE}}
{{#NOTE}}<p class="hint" dir="auto">{{TEXT}}</p>
{{/NOTE}}
<p class="hint">Walked once around, the edges of a loop must lead back to where they began. Translation and rotation say by how much they do not; T&sup2; compares that with the uncertainty of the whole walk, and beyond the limit one of its edges is wrong: most likely the one that the failing loops have in common. The solution is not needed for this, only the measurements.</p>
</section>
