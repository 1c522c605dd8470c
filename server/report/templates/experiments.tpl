{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body>
<main>
<nav class="crumbs" aria-label="Where you are"><a href="../">Fleet</a> / <span>experiments</span></nav>
<header>
<h1>Experiments</h1>
<p class="meta">How the method was tested, on data whose truth is known.</p>
</header>
{{#LIST}}
<section class="card">
<div class="scroll" tabindex="0" role="region" aria-label="Experiments">
<table class="list">
<thead><tr><th scope="col">Experiment</th><th scope="col">Written</th><th scope="col">Figures</th></tr></thead>
<tbody>
{{#EXPERIMENT}}<tr><th scope="row"><a href="{{NAME}}/"><bdi>{{TITLE}}</bdi></a></th><td class="text">{{TIME}}</td><td class="text">{{#FIGURES}}<a href="{{NAME}}/experiment.json">experiment.json</a>{{/FIGURES}}</td></tr>
{{/EXPERIMENT}}
</tbody>
</table>
</div>
{{#CUT}}<p class="hint">{{TEXT}}</p>{{/CUT}}
</section>
{{/LIST}}
{{#EMPTY}}
<section class="card empty">
<h2>No experiment is here yet</h2>
<p>An experiment is a folder <code>experiments/NAME</code> below the server's data folder, with an <code>index.html</code> and, if it likes, its figures in <code>experiment.json</code>.</p>
</section>
{{/EMPTY}}
</main>
</body>
</html>
