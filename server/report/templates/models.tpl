{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body>
<main>
<nav class="crumbs" aria-label="Where you are"><a href="../">Fleet</a> / <span>rig models</span></nav>
<header>
<h1>Rig models</h1>
<p class="meta">Kinds of machines, as sessions name them and as they were set.</p>
</header>
{{#LIST}}
<section class="card">
<div class="scroll" tabindex="0" role="region" aria-label="Rig models">
<table class="list">
<thead><tr><th scope="col">Rig model</th><th scope="col">Set</th><th scope="col" class="num">Robots</th></tr></thead>
<tbody>
{{#MODEL}}<tr><th scope="row"><a href="{{PATH}}/"><bdi>{{NAME}}</bdi></a></th><td class="text">{{#SET}}version {{VERSION}}{{/SET}}{{#NOT_SET}}<span class="soft">not set</span>{{/NOT_SET}}</td><td data-label="Robots">{{ROBOTS}}</td></tr>
{{/MODEL}}
</tbody>
</table>
</div>
{{#CUT}}<p class="hint">{{TEXT}}</p>{{/CUT}}
</section>
{{/LIST}}
{{#EMPTY}}
<section class="card empty">
<h2>No rig model is known yet</h2>
<p>A session names its own as <code>rig_model</code> in session.yaml. What a model has, where, and which pairs it needs is set with</p>
<pre><code>rigcal model set FILE --reason TEXT</code></pre>
</section>
{{/EMPTY}}
</main>
</body>
</html>
